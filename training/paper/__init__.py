"""The paper's own networks and experiments, section by section, beside the shipped networks'.

``config.toml`` is the whole configuration. The commands, in their order:

    python -m training.paper.generate      data/paper/: random contours, meshed by Gmsh at nine target edge lengths
    python -m training.paper.train         runs/paper/: NN1, NN2 and NN3 (sections 2.3 to 2.5)
    python -m training.paper.adaptive      NN3*, Table 1 and Fig. 26
    python -m training.paper.surfaces      Figs. 15 and 16
    python -m training.paper.export        paper_models/*.onnx, of what the two above have trained
    python -m training.paper.populations   Figs. 17 and 18
    python -m training.paper.exclusion     the radius of exclusion, of which the paper's is too small
    python -m training.paper.mixture       the share of the reference's vertices that NN3 learns from
    python -m training.paper.counts        Fig. 19
    python -m training.paper.resolution    Fig. 21
    python -m training.paper.stages 22     NN2 alone
    python -m training.paper.stages 24     the triangulation with calculated tables
    python -m training.paper.stages 25     NN3 alone
    python -m training.paper.stages 27     the whole scheme
    python -m training.paper.speed         section 5
    python -m training.paper.domains       Table 2, Figs. 28 to 30
    python -m training.paper.learning      learning curves over populations
    python -m training.paper.report        docs/reproduction.md, from what the others have left
    python -m training.paper               all of them

What the experiments find is kept in ``training/paper/results/``, in the repository, so that the report can be made
without data and without training. ``adaptive``, ``resolution``, ``mixture`` and ``learning`` train networks of their
own.
"""
