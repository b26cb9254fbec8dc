"""Sentences for codes and numbers of the floors below; no outcome depends on any of them."""
