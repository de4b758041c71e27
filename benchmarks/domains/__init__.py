"""Domains of any size and shape beside Gmsh's meshes of them: ``python -m benchmarks.domains`` (part of `make bench`).

`cases` are the domains, `outlines` the coasts among them, `meshers` the meshers, `measures` what is measured of a mesh,
`comparison` of all; `growth` the large circles, `random_domains` and `invalid` the random ones; `goals`, `report` and
`pictures` what is made of it.
"""
