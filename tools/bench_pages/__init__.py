"""The pages of `raysheaf bench`, one module for each command."""
