"""Sentences: what codes and numbers of the floors below come to in words; no outcome depends on any of them."""
