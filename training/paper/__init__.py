"""The paper's own networks and experiments, section by section, beside the shipped networks'.

``config.toml`` is the whole configuration. The commands, in their order:

    python -m training.paper.generate      data/paper/: random contours, meshed by Gmsh at nine target edge lengths
    python -m training.paper.train         runs/paper/: NN1, NN2, NN3 (section 2.3 to 2.5), and those of single figures
    python -m training.paper.export        paper_models/*.onnx
    python -m training.paper.populations   Figs. 17 and 18
    python -m training.paper.counts        Fig. 19
    python -m training.paper.resolution    Fig. 21
    python -m training.paper.exclusion     the radius of exclusion, of which the paper's is too small
    python -m training.paper.mixture       the share of the reference's vertices that NN3 learns from
    python -m training.paper.stages        Figs. 22, 24, 25 and 27
    python -m training.paper.adaptive      Table 1, Figs. 15, 16 and 26
    python -m training.paper.speed         section 5
    python -m training.paper.domains       Table 2
    python -m training.paper.learning      learning curves over populations
    python -m training.paper.report        docs/reproduction.md, from what the others have left in runs/paper/
    python -m training.paper               all of them
"""
