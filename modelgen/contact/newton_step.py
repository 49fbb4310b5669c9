"""One Newton step of the extremality system in the tangent plane, with the margin beside it.

Residuals in the frame [t1 t2 n] of o's point: e1 = T^T (P_f - P_o), e2 = T^T (n + n_f) with both exterior
normals, and the heights h_o, h_f of the points over their surfaces. They replace (2.1), which is void at
P_f = P_o. In the residual of the record |n + n_f| stands for e2, which equal normals make zero too. The step
moves the points by a and b along and by -h across their surfaces:

    (K_f + K_o + d K_f K_o) a = -e2' + K_f e1',   b = (I + d K_o) a - e1'

where e1', e2' include what the steps across the surfaces turn the normals by.
"""

from __future__ import annotations

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Placement
from modelgen.contact.singularity_margin import margin
from modelgen.contact.surface_points import SurfacePoint
from modelgen.contact.tangent_plane_form import contact_frame, touch
from modelgen.geometry.frames import dot, solve2, zeros


def tangent_place(pair: Pair, o: SurfacePoint, f: SurfacePoint) -> Placement:
    """Newton step of the implicit and mixed forms; exact up to second order in the residuals."""
    frame = contact_frame(pair, o)
    at = touch(pair, frame, o, f)
    K_o, K_f, d = at.K_o, at.K_f, at.d
    point_o = pair.o.centre + ca.mtimes(pair.o.rotation, at.l_o)
    point_f = pair.f.centre + ca.mtimes(pair.f.rotation, at.l_f)
    e1 = zeros(2) if o.x is None else ca.mtimes(frame.T_w.T, point_f - point_o)
    e2 = ca.mtimes(frame.T_f.T, f.normal)
    bend_o = ca.mtimes(frame.T_o.T, o.bend) * o.height
    bend_f = ca.mtimes(frame.T_f.T, f.bend) * f.height
    e1_next, e2_next = e1 + d * bend_o, e2 - bend_o - bend_f
    A = K_o + K_f + d * ca.mtimes(K_f, K_o)
    a = solve2(A, ca.mtimes(K_f, e1_next) - e2_next)
    b = a + d * ca.mtimes(K_o, a) - e1_next
    step_o = o.eta_rate(ca.mtimes(frame.T_o, a) - o.height * o.normal)
    step_f = f.eta_rate(ca.mtimes(frame.T_f, b) - f.height * f.normal)
    apart = frame.n_f + f.normal
    off = ca.sqrt(dot(e1, e1) + o.height * o.height + f.height * f.height)
    return Placement(
        eta_next=pair.eta + ca.vertcat(step_o, step_f),
        d=d,
        residual=ca.vertcat(off, ca.sqrt(dot(apart, apart))),
        margin=margin(K_o, K_f, d),
        normal=frame.n_w,
        point_o=point_o if o.x is not None else point_f - d * frame.n_w,
        point_f=point_f,
    )
