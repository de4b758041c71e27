"""The report's sentences: what each experiment did, and why its numbers differ from the paper's.

Findings in them are those of the kept results; numbers that the results have are filled in by `markdown` and `report`.
"""

from __future__ import annotations

import textwrap

from .answers import CLOSE, CLOSE_QUALITY, ENOUGH

PAPER_POPULATIONS = {4: 6000, 6: 12000, 8: 24000}  # contours by N_C, as far as the text says

POPULATIONS = """The paper's populations grow nearly exponentially; it gives numbers for 4, 6 and 8 edges only. Each
contour is meshed at nine target edge lengths, and each mesh is an example for NN1 and, by its number of inner vertices,
for the NN2 and NN3 of its group. NN2 learns from at most {nn2[meshes]:,} meshes of a group; NN3 from the vertices of at
most {nn3[references]:,}, which are half of each batch (Fig. 25), and from random groups of inner vertices in
{nn3[meshes]:,} of its contours, in each the paper's 50 (N_I up to 4), 100 (5 to 8) or 200. An epoch is all examples of
a network once; a mesh is 100 examples for NN2, a patch of the grid each. NN3 sees Gmsh's meshes oftener than random
vertices, so it has two columns. Numbers in brackets are the paper's epochs. {exceptions}
With 4 edges Gmsh inserts none or one vertex almost always, as long frozen edges win over the target, so groups of 3 to
6 vertices hardly exist here: their NN3 learn from random vertices almost alone, and are not tested. With 16 edges and
l_s 0.2 it inserts about 50, which the paper's figures do not reach either; the picture ends at 40."""

MIXTURE = """With the paper's share (one example in {one_in} for N_C {n}, N_I {m}), NN3 learns tables of bad meshes: a
facet's best entry is {best[random]:.2f} with random vertices, and {best[reference]:.2f} with Gmsh's, on average. The
paper's 5000 epochs show each of Gmsh's meshes 5000 times all the same; to show them some {fewest:,} times in a large
group and some thousands in a small one, they are half of each batch here, and more would be better still; random ones
stay because the paper has them. The table compares four NN3 of this group after {steps:,} batches, connecting Gmsh's
vertices and those that NN2 places, sub-contours by CDT. It is
made by `python -m training.paper.mixture`."""

COUNTS = """NN1 against Gmsh's count. The paper's numbers at l_s = 0.2 belong to another setting of its mesher's size:
its standard deviation of N_I (in brackets here) is 5.2 with 16 edges and 1.4 with 4; here it is larger with 16 and
smaller with 4 edges, and the errors with it, hence their large ratio. With 6 edges three times as long as l_s Gmsh
inserts very different numbers into similar contours, so at l_s 0.2 the error is largest there and falls with N_C from 6
edges on. At large l_s it grows with N_C as in the paper, and is larger, for which training is probably too short (the
learning curve below). The shipped NN1 is taught the count of better meshes, not Gmsh's (and only l_s from 0.25 on), so
its distance to Gmsh's count is no error of its own: `docs/results/scheme.md`. Figs. 20 and 23 show single examples and
are not repeated."""

RESOLUTION = """NN2 for one inner vertex, trained for each grid, patches of 2×2 points on all of them, for as many
batches each: a grid twice as fine has four times the patches, so that these are a quarter of the epochs. With 12 and
more edges Gmsh makes next to no mesh with one inner vertex, so there are no such groups. The differences between grids
are within two standard errors: NN2's own error hides what a finer grid could gain, even from 10×10 to 20×20, where the
paper still sees a gain. Scores are interpolated between grid points."""

STAGES = {
    22: (
        "the places of inner vertices (NN2 alone)",
        """As many vertices as Gmsh has, placed by NN2 and connected by CDT, against Gmsh's mesh. The errors grow with
the number of vertices, as in the paper. The radius around a chosen vertex in which grid points are excluded is 0.6 even
edge lengths, not the paper's 0.1 l_s, which is less than the grid's spacing, so that the next vertex would be beside
the first (the table, made by `python -m training.paper.exclusion`). The shipped networks move all vertices at once
after placing them, and were taught by meshes that are better than Gmsh's, so their error is negative.""",
    ),
    24: (
        "the triangulation with calculated tables",
        """Gmsh's vertices, connected by Algorithm 3 as it is in the library with calculated tables, against CDT of
them; no network is asked. It orders entries with the element's own quality beside the table's, and closes small
sub-contours with the best of all their triangulations; so it is a little better than CDT, where the paper's is a little
worse.""",
    ),
    25: (
        "connections (NN3 alone)",
        """Gmsh's vertices, connected by Algorithm 3 with NN3's tables, against CDT of them. The errors are largest
from N_I 5 on, and are above the paper's there, because of the sub-contours that are left when a contour's elements are
made: they are no contours with a vertex in each sector, which is all that NN3 has seen, and the paper, which has no
NN3 for odd numbers of edges, does not say how it meshes them. Here NN3 is asked for them where their group was
trained, but for those of up to 8 edges without inner vertices, of which the library takes the best triangulation.
Where CDT decides in all sub-contours instead, the errors are below the paper's but in one of the groups that it names
(in brackets above, dotted in the picture, and a column of the table), so it is in them that its networks and these
differ. Longer training helps: after 20,000 batches (8, 12) was at 42.8 %, after 10,000 (10, 8) at 23.0 %. N_C 10, N_I
1 is worse than its neighbours with or without sub-contours: it has {few} meshes to learn from. NN3's one value per
entry is q_worst, which very often is that of an element elsewhere, so that small errors decide between entries that
should tie; the library takes no more than the element's own quality for it. Groups that were not trained have no
point. The shipped NN3 sees one element at a time, with exact geometry, and hardly errs.""",
    ),
    27: (
        "the whole scheme",
        """Only contours and target edge lengths are given, against Gmsh's mesh of whatever number of vertices. Groups
are by the number that the paper's NN1 asks for, and only groups with all three networks are meshed; the shipped
networks mesh the same contours. As in the paper, the errors are above those of the parts; here they are about their
sum, in the paper (19.4 of 17.3 + 10 %) well below it. N_C 4 and 6 without inner vertices are meshed by the library's
best triangulation, without NN3. The shipped networks have groups above 0 here: groups are of what the paper's NN1 asks
for, and l_s goes down to 0.2, which they were not taught; by Gmsh's count and from l_s 0.3 on they are better than Gmsh
in every group of at least 200 contours (`docs/results/scheme.md`).""",
    ),
}

ADAPTIVE = """Sample sizes are Table 1's; of the mean numbers of inner vertices a contour that they are drawn from, the
paper's are in brackets. The paper does not say how an example is made of a vertex and an edge: here it is a contour,
N_I vertices and one edge, a random one for random vertices, and for adaptive ones the edge whose surface they were
sampled from, by the root of its curvature; the answer is that edge's row of the table. Nor does it give NN3*'s layers:
here they are NN3's, with the edge as N_C further inputs. All eight networks of an N_I see as many batches, and learn
from at most {contours} contours of the group, where the paper has 2000. With one inner vertex the gain at 96 % is the
paper's, but within two standard errors of none, and half of it is that this random sample came out worse than smaller
ones. With two and four, random samples, which are up to a third larger, are as good or better. The size of a sample
matters little either way, and neither do more contours (the learning curve below). Sub-contours have no NN3*, but the
constrained Delaunay triangulation's element. In the pictures of Figs. 15 and 16 the edge is red, the other inner
vertex a red square, and what is sampled white."""

DOMAINS = """Meshed by `tessera.mesh` with the shipped networks. The paper's contours and targets are not given, so
these are those of `docs/results/domains.md`, which are like its figures and are compared with Gmsh there. The airfoil,
a NACA 0012, has a sharp tail of 16 degrees: the element in it cannot be better than 0.47, whoever the mesher is, so it
is left out of q_worst and stands beside it. The paper's 0.69 needs a tail of 26 degrees or more, or a blunt one, if it
counts that element. The paper divides its plate into four and refines; the library divides, refines and remeshes."""

SPEED = """Milliseconds a contour, in one process and in the same rounds, the fastest of three, for contours whose group
is trained: in a batch, and one call of the scheme for each. These are small contours at l_s 1 only;
`benchmarks/results/speed.md` has larger ones, and domains. Gmsh's time has its model's set-up in it, through its Python
API; it is written in C++, the rest in Python. Most of a call for one contour is the cost of calling numpy and
onnxruntime, which a batch shares: there both take about Gmsh's time or less."""

LEARNING = """One NN1, NN2, NN3 and NN3*, each trained on shares of its population for as many batches (epochs differ),
measured on test contours (NN3 and NN3* on the reference's vertices in them). From a quarter of the population on, none
gains measurably from more contours after so few batches. All still gain from longer training, whose loss (NN1's
absolute, the others' squared) the table has, too: it is training that is missing here more than contours; the paper's
3000 to 5000 epochs are {ratios} times as long, of one network or another."""

DEPARTURES = """Where the paper is read, or left, for something else:

- Weight decay is decoupled from Adam's gradient (AdamW), in place of the gradient of an L2 loss. At a rate of 1e-4 and
  a decay of 0.1 it takes about 5 % off the weights in 5,000 batches, and off biases and batch normalisation too.
- Products of matrices are in bfloat16 while NN3 and NN3* are trained.
- NN3's pooling goes round the contour where the number of pairs is odd (N_C 6, 10 and 14), so that none is lost.
- NN3 learns and answers an entry's q_worst alone; q_mean, which breaks ties of labels in the paper, is not learnt.
- Inner vertices come to NN3 in another random order each time, and its tables' columns with them.
- Batches are drawn with replacement, so an epoch is so many examples, not each of them once.
- Scores are interpolated over 3×3 grid points at every l_s, where the paper has those within 0.2 l_s, which at small
  l_s are none; the radius of exclusion is larger (Fig. 22).
- Algorithm 3 is the library's: it looks at an element's own quality too (Fig. 24), and takes the best triangulation of
  sub-contours of up to 8 edges without inner vertices, which never ask NN3.
- Half of NN3's examples have Gmsh's vertices (Fig. 25)."""


def introduction(config: dict, gmsh: str) -> str:
    """What was done, and how to read the answers."""
    data = config["data"]
    l_s, seeds = data["targets"], data["seeds"]
    return f"""NN1, NN2, NN3 and NN3* with the layers, losses, batch size (512), learning rate (1e-4) and weight decay
of Papagiannopoulos, Clausen and Avellan, *How to teach neural networks to mesh: Application on 2-D simplicial
contours*, one NN1 for each N_C, one NN2 and NN3 for each (N_C, N_I); beside them the networks that ship. Each section
names the command that makes its numbers; they are kept in `training/paper/results/`, from which
`python -m training.paper.report` makes this page. `python -m training.paper` runs all commands. The reference is
Gmsh {gmsh}, Delaunay, contour edges frozen, one size for the whole contour (`training/reference.py`); l_s is
{l_s[0]:g} to {l_s[-1]:g}, seeds of contours are {seeds["train"]} (training) and {seeds["test"]} (tests). The paper's
networks are called by `tessera.mesh_contour(points, l, networks="paper")`, from `paper_models/`; "paper*" takes NN3*
for NN3.

e = (q_reference − q) / q_reference in per cent, ē its mean over meshes, ± its standard error; negative is better than
the reference. Test populations are {test_sizes(data["test"])}. Test groups have as many meshes as 95 % confidence and
5 % interval ask for (section 3.2.1), where there are so many; the whole scheme (Fig. 27) has up to
{config["test"]["contours"]}. ± is that of the tested meshes: each network was trained once, and how much another
training would differ is not in it.

*Reproduced* is within {100 * CLOSE:.0f} % of the paper's number, or within two standard errors; otherwise it is
*better* or *worse*. Table 2's qualities are reproduced within {CLOSE_QUALITY:g}. A claim that is no number is
reproduced or worse. A gain of adaptive sampling (Fig. 26) that could be none, within two standard errors, is worse.
Largest errors are those of groups of at least {ENOUGH} meshes. *Not tested* is what was not measured, what the errors
are too large to tell, and a largest error that is not worse already where some N_C are not measured."""


def test_sizes(counts: dict[int, int]) -> str:
    """How many contours of each N_C are tested, the commonest number first."""
    sizes = sorted(set(counts.values()), key=lambda size: -list(counts.values()).count(size))
    parts = [f"{sizes[0]:,} contours of each N_C"]
    for size in sizes[1:]:
        parts.append(f"{size:,} of N_C {', '.join(str(n) for n, count in counts.items() if count == size)}")
    return ", ".join(parts)


def clusters(tested: list[tuple[int, dict]]) -> str:
    """What ± leaves out; tested: N_C and test group (`populations.of_test`)."""
    if not tested:
        return ""
    n, worst = max(tested, key=lambda pair: pair[1]["alike"])
    return f"""A contour is meshed at several l_s, and its meshes that have as many vertices are in one group. They are
counted apart, so that ± is a little too small: if all meshes of a contour had one error, it would be
{worst["alike"]:.1f} times as large in the group where that matters most (N_C {n}, N_I {worst["m"]}: {worst["meshes"]}
meshes of {worst["contours"]} contours). The tables have both numbers."""


def filled(text: str) -> str:
    """Paragraphs in lines of 120 characters."""
    width = {"width": 120, "break_long_words": False, "break_on_hyphens": False}
    return "\n\n".join(textwrap.fill(" ".join(part.split()), **width) for part in text.split("\n\n"))


def section(text: str, command: str) -> str:
    """A section's text, and the command that makes its numbers."""
    return f"{filled(text)}\nMade by `python -m training.paper.{command}`."
