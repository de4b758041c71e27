"""Which objects can be read; apart from the reading itself, so that menus need not load the mesher."""

READABLE = frozenset({"CURVE", "FONT"})
