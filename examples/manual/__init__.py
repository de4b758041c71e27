"""The manual's pictures: ``python -m examples.manual`` makes all of them again, and says how."""
