"""Model files: what a user writes, checked, and turned into models."""
