"""Region numbers of points and samples that belong to no region. Regions are numbered from 0."""

ISOLATED = -1  # of a point on its own
BESIDE = -2  # of a point beside the regions, with target 0
