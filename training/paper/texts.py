"""The report's sentences: what each experiment did, and why its numbers differ from the paper's."""

from __future__ import annotations

from .claims import CLOSE, ENOUGH

PAPER_POPULATIONS = {4: "6,000", 6: "12,000", 8: "24,000"}

POPULATIONS = """The paper's populations grow nearly exponentially; it gives numbers for 4, 6 and 8 edges only. Each
contour is meshed at nine target edge lengths, and each mesh is an example for NN1 and, by its number of inner vertices,
for the NN2 and NN3 of its group. NN2 learns from at most {nn2[meshes]:,} meshes of a group; NN3 from the vertices of at
most {nn3[references]:,}, which are half of each batch (Fig. 25), and from random groups of inner vertices in
{nn3[meshes]:,} of its contours, in each the paper's 50 (N_I up to 4), 100 (5 to 8) or 200. An epoch is all examples of
a network once; a mesh is 100 examples for NN2, a patch of the grid each. Numbers in brackets are the paper's epochs.
With 4 edges Gmsh inserts none or one vertex almost always, as long frozen edges win over the target, so groups that the
paper has with 3 and 4 vertices hardly exist here: their NN3 learn from random vertices alone, and are not tested. With
16 edges and l_s 0.2 it inserts about 50, which the paper's figures do not reach either; the picture ends at 40."""

MIXTURE = """With the paper's share, of N_C {n} and N_I {m} one example in {one_in}, NN3 learns tables of bad meshes: a
facet's best entry is {best[random]:.2f} with random vertices, and {best[reference]:.2f} with Gmsh's, on average. The
paper's 5000 epochs show each of Gmsh's meshes 5000 times all the same; to show them a few hundred times here, they are
half of each batch, and more would be better still; random ones stay for being the paper's. Four NN3 of this group
after {steps:,} batches, connecting Gmsh's vertices and those that NN2 places, sub-contours by CDT:"""

COUNTS = """NN1 against Gmsh's count. The paper's numbers at l_s = 0.2 belong to another setting of its mesher's size:
its standard deviation of N_I (in brackets here) is 5.2 with 16 edges and 1.4 with 4; here it is larger with 16 and
smaller with 4 edges, and the errors with it, whence their large ratio. At large l_s, where counts are like the paper's,
the error is larger for want of training (the learning curve below). The shipped NN1 is taught the count of better
meshes, not Gmsh's (and only l_s from 0.25 on), so its distance to Gmsh's count is no error of its own:
`docs/results/scheme.md`."""

RESOLUTION = """NN2 for one inner vertex, trained for each grid, patches of 2×2 points on all of them, for as many
batches each. With 12 and more edges Gmsh makes next to no mesh with one inner vertex, so there are no such groups.
NN2's own error is larger here than what a finer grid could gain, even from 10×10 to 20×20, where the paper still sees a
gain: scores are interpolated between grid points, and are as good on all grids."""

STAGES = {
    22: (
        "the places of inner vertices (NN2 alone)",
        """As many vertices as Gmsh has, placed by NN2 and connected by CDT, against Gmsh's mesh. The errors grow with
the number of vertices, as in the paper. The radius around a chosen vertex in which grid points are excluded is 0.6 even
edge lengths, not the paper's 0.1 l_s, which is less than the grid's spacing, so that the next vertex would be beside
the first (the table). The shipped networks move all vertices at once after placing them, and were taught by meshes that
are better than Gmsh's, so their error is negative.""",
    ),
    24: (
        "the triangulation with calculated tables",
        """Gmsh's vertices, connected by Algorithm 3 as it is in the library with calculated tables, against CDT of
them. It orders entries with the element's own quality beside the table's, and closes small sub-contours with the best
of all their triangulations; so it is a little better than CDT, where the paper's is a little worse.""",
    ),
    25: (
        "connections (NN3 alone)",
        """Gmsh's vertices, connected by Algorithm 3 with NN3's tables, against CDT of them. The errors grow with N_I
from 4 on, and are above the paper's, for the sub-contours that are left when a contour's elements are made: they are
no contours with a vertex in each sector, which is all that NN3 has seen, and the paper, which has no NN3 for odd
numbers of edges, does not say how it meshes them. Here NN3 is asked wherever its group was trained. Where CDT decides
in all sub-contours instead, errors like the paper's are left (in brackets above, dotted in the picture, and a column
of the table). NN3's one value per entry is q_worst, which very often is that of an element elsewhere, so that small
errors decide between entries that should tie; the library takes no more than the element's own quality for it. Groups
that were not trained have no point. The shipped NN3 sees one element at a time, with exact geometry, and hardly
errs.""",
    ),
    27: (
        "the whole scheme",
        """Only contours and target edge lengths are given, against Gmsh's mesh of whatever number of vertices. Groups
are by the number that the paper's NN1 asks for, and only groups with all three networks are meshed; the shipped
networks mesh the same contours. As in the paper, the errors are above those of the parts, often about their sum.""",
    ),
}

ADAPTIVE = """Sample sizes are Table 1's. The paper does not say how an example is made of a vertex and an edge: here
it is a contour, N_I vertices and one edge, a random one for random vertices, and for adaptive ones the edge whose
surface they were sampled from, by the root of its curvature; the answer is that edge's row of the table. Nor does it
give NN3*'s layers: here they are NN3's, with the edge as N_C further inputs. All eight networks of an N_I see as many
batches, and learn from far fewer contours than the paper's 2000, so that what is missing are contours more than
vertices in them: sample sizes hardly matter, and adaptive samples give about the same errors as random ones that are a
sixth to a third more; a gain within two standard errors of none is called worse. Sub-contours have no NN3*, but the
constrained Delaunay triangulation's element. In the pictures of Figs. 15 and 16 the edge is red, the other inner vertex
a red square, and what is sampled white."""

DOMAINS = """Made by `tessera.mesh` with the shipped networks. The paper's contours and targets are not given, so these
are those of `docs/results/domains.md`, which are like its figures and are compared with Gmsh there. The airfoil, a NACA
0012, has a sharp tail of 16 degrees: the element in it cannot be better than 0.47, whoever the mesher is, so it is left
out of q_worst and stands beside it. The paper's 0.69 needs a tail of 26 degrees or more, or a blunt one, if it counts
that element. The paper divides its domains by hand and refines; the library divides, refines and remeshes."""

SPEED = """Milliseconds a contour, in one process and in the same rounds, the fastest of three, at l_s 1, for contours
whose group is trained: in a batch, and one call of the scheme for each. Gmsh's time has its model's set-up in it,
through its Python API; it is written in C++, the rest in Python. Most of a call for one contour is the cost of calling
numpy and onnxruntime, which a batch shares: there both take about Gmsh's time or less."""

LEARNING = """One NN1, NN2 and NN3, each trained on shares of its population for as many batches (epochs differ),
measured on test contours (NN3 on the reference's vertices in them). NN1 still gains from more contours, NN2 and NN3
hardly. All still gain from longer training, whose loss (NN1's absolute, the others' squared) the table has, too: it is
training that is missing here more than contours; the paper's 3000 to 5000 epochs are some dozens to hundreds of times
as long."""


def introduction(config: dict, gmsh: str) -> str:
    """What was done, and how to read the answers."""
    data = config["data"]
    l_s, seeds = data["targets"], data["seeds"]
    return f"""NN1, NN2, NN3 and NN3* with the layers, losses, batch size (512), learning rate (1e-4) and weight decay
(read as decoupled from Adam's gradient) of Papagiannopoulos, Clausen and Avellan, *How to teach neural networks to
mesh: Application on 2-D simplicial contours*, one NN1 for each N_C, one NN2 and NN3 for each (N_C, N_I); beside them
the networks that ship. Made by `python -m training.paper.report` from what the commands in `training/paper/__init__.py`
have left; `python -m training.paper` runs them all. The reference is Gmsh {gmsh}, Delaunay, contour edges frozen, one
size for the whole contour (`training/reference.py`); l_s is {l_s[0]:g} to {l_s[-1]:g}, seeds of contours are
{seeds["train"]} (training) and {seeds["test"]} (tests). The paper's networks are called by
`tessera.mesh_contour(points, l, networks="paper")`, from `paper_models/`; "paper*" takes NN3* for NN3.

e = (q_reference − q) / q_reference in per cent, ē its mean over contours, ± its standard error; negative is better than
the reference. Test groups have as many contours as 95 % confidence and 5 % interval ask for (section 3.2.1), where
there are so many. *Reproduced* is within {100 * CLOSE:.0f} % of the paper's number, or within two standard errors;
otherwise it is *better* or *worse*. Largest errors are those of groups of at least {ENOUGH} contours."""
