"""A convex body of few corners in the place of one of many."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def few_corners(points: Array, most: int) -> tuple[Array, float]:
    """At most so many corners of the hull of some points [m] (n, 3), and how far any of the points lies outside the
    hull of these [m]; ValueError where the points lie in a plane.

    From the farthest points along the axes on, the one that lies farthest outside is taken next.

    Valid    the hull of the corners lies within that of the points
    Checked  tests/orbital/test_corners.py
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = points[np.sort(ConvexHull(points).vertices)]
        if len(corners) <= most:
            return corners, 0.0
        chosen = list(dict.fromkeys(int(k) for axis in corners.T for k in (np.argmin(axis), np.argmax(axis))))
        if len(chosen) < 4 or np.linalg.matrix_rank(corners[chosen] - corners[chosen[0]], tol=1e-9) < 3:
            apart = np.linalg.norm(corners - corners.mean(axis=0), axis=1)
            chosen += [int(k) for k in np.argsort(-apart, kind="stable")[:4] if int(k) not in chosen]
        while True:
            planes = ConvexHull(corners[chosen]).equations
            outside = (corners @ planes[:, :3].T + planes[:, 3]).max(axis=1)
            if len(chosen) >= most:
                return corners[chosen], max(float(outside.max()), 0.0)
            chosen.append(int(np.argmax(outside)))
    except QhullError:
        raise ValueError("the points lie in a plane, and have no hull") from None
