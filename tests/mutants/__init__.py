"""Small changes of liegen's source, one at a time, that the tests must catch.

Not a part of the normal run: `python -m tests.mutants` from the root of a checkout. Each file `*.toml` lists
the mutants of one area and the tests that are the narrowest for it.
"""
