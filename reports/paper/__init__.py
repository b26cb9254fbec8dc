"""Ledger of the paper: what each of its claims comes to in stored studies, by rules, under other readings too."""
