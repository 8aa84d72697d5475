"""Spatial velocities, wrenches and articulated inertias of eight copies: moved from frame to frame, a joint taken out.

An articulated inertia is its angular part A and linear part M, symmetric (xx, yy, zz, xy, xz, yz), and the mixed part B by rows.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.simd.vector import in_place


@in_place
def turn_forward(c: Any, s: Any, x: Any, y: Any) -> Any:
    """Coordinates of a vector after the axes turned by an angle of cosine c and sine s (parent to child)."""
    return c * x + s * y, c * y - s * x


@in_place
def turn_symmetric(c: Any, s: Any, xx: Any, yy: Any, zz: Any, xy: Any, xz: Any, yz: Any) -> Any:
    """A symmetric tensor turned back about z (child to parent)."""
    # The trace stays, so that five multiplications are enough for three elements.
    h = s * (xx - yy) + c * (xy + xy)
    return xx - s * h, yy + s * h, zz, c * h - xy, c * xz - s * yz, s * xz + c * yz


@in_place
def turn_general(
    c: Any, s: Any, xx: Any, xy: Any, xz: Any, yx: Any, yy: Any, yz: Any, zx: Any, zy: Any, zz: Any
) -> Any:
    """A general tensor turned back about z (child to parent)."""
    axx = c * xx - s * yx
    axy = c * xy - s * yy
    axz = c * xz - s * yz
    ayx = s * xx + c * yx
    ayy = s * xy + c * yy
    ayz = s * xz + c * yz
    return (
        c * axx - s * axy,
        s * axx + c * axy,
        axz,
        c * ayx - s * ayy,
        s * ayx + c * ayy,
        ayz,
        c * zx - s * zy,
        s * zx + c * zy,
        zz,
    )


@in_place
def _shift_tensors(x: Any, y: Any, z: Any, angular: Any, mixed: Any, linear: Any) -> Any:
    """Angular and mixed parts of an articulated inertia, taken about a point that lies at −(x, y, z).

    B' = B + T M and A' = A − B T + T B'ᵀ with T v = (x, y, z) × v.
    """
    axx, ayy, azz, axy, axz, ayz = angular
    bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
    mxx, myy, mzz, mxy, mxz, myz = linear
    cxx = bxx + (y * mxz - z * mxy)
    cxy = bxy + (y * myz - z * myy)
    cxz = bxz + (y * mzz - z * myz)
    cyx = byx + (z * mxx - x * mxz)
    cyy = byy + (z * mxy - x * myz)
    cyz = byz + (z * mxz - x * mzz)
    czx = bzx + (x * mxy - y * mxx)
    czy = bzy + (x * myy - y * mxy)
    czz = bzz + (x * myz - y * mxz)
    return (
        (
            axx + (y * bxz - z * bxy) + (y * cxz - z * cxy),
            ayy + (z * byx - x * byz) + (z * cyx - x * cyz),
            azz + (x * bzy - y * bzx) + (x * czy - y * czx),
            axy + (z * bxx - x * bxz) + (y * cyz - z * cyy),
            axz + (x * bxy - y * bxx) + (y * czz - z * czy),
            ayz + (x * byy - y * byx) + (z * czx - x * czz),
        ),
        (cxx, cxy, cxz, cyx, cyy, cyz, czx, czy, czz),
    )


@in_place
def turn_articulated(c: Any, s: Any, angular: Any, mixed: Any, linear: Any, bias: Any) -> Any:
    """An articulated inertia and its bias wrench turned back about z (child to parent)."""
    axx, ayy, azz, axy, axz, ayz = angular
    bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
    mxx, myy, mzz, mxy, mxz, myz = linear
    px, py, pz, fx, fy, fz = bias
    return (
        turn_symmetric(c, s, axx, ayy, azz, axy, axz, ayz),
        turn_general(c, s, bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz),
        turn_symmetric(c, s, mxx, myy, mzz, mxy, mxz, myz),
        (c * px - s * py, s * px + c * py, pz, c * fx - s * fy, s * fx + c * fy, fz),
    )


@in_place
def turn_articulated_about_x(c: Any, s: Any, angular: Any, mixed: Any, linear: Any, bias: Any) -> Any:
    """An articulated inertia and its bias wrench turned back about x (child to parent)."""
    axx, ayy, azz, axy, axz, ayz = angular
    bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
    mxx, myy, mzz, mxy, mxz, myz = linear
    px, py, pz, fx, fy, fz = bias
    # The same formulas with the axes in the order y, z, x.
    ayy, azz, axx, ayz, axy, axz = turn_symmetric(c, s, ayy, azz, axx, ayz, axy, axz)
    myy, mzz, mxx, myz, mxy, mxz = turn_symmetric(c, s, myy, mzz, mxx, myz, mxy, mxz)
    byy, byz, byx, bzy, bzz, bzx, bxy, bxz, bxx = turn_general(c, s, byy, byz, byx, bzy, bzz, bzx, bxy, bxz, bxx)
    return (
        (axx, ayy, azz, axy, axz, ayz),
        (bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz),
        (mxx, myy, mzz, mxy, mxz, myz),
        (px, c * py - s * pz, s * py + c * pz, fx, c * fy - s * fz, s * fy + c * fz),
    )


@in_place
def shift_articulated(x: Any, y: Any, z: Any, angular: Any, mixed: Any, linear: Any, bias: Any) -> Any:
    """An articulated inertia and its bias wrench, taken about a point that lies at −(x, y, z)."""
    angular, mixed = _shift_tensors(x, y, z, angular, mixed, linear)
    px, py, pz, fx, fy, fz = bias
    px = px + (y * fz - z * fy)
    py = py + (z * fx - x * fz)
    pz = pz + (x * fy - y * fx)
    return angular, mixed, linear, (px, py, pz, fx, fy, fz)


@in_place
def slide_articulated_back(q: Any, angular: Any, mixed: Any, linear: Any, bias: Any) -> Any:
    """``shift_articulated`` along z alone."""
    angular, mixed = _shift_tensors(0.0, 0.0, q, angular, mixed, linear)
    px, py, pz, fx, fy, fz = bias
    return angular, mixed, linear, (px - q * fy, py + q * fx, pz, fx, fy, fz)


@in_place
def turn_motion(ca: Any, sa: Any, c: Any, s: Any, wx: Any, wy: Any, wz: Any, vx: Any, vy: Any, vz: Any) -> Any:
    """A spatial velocity or acceleration in axes turned about x (ca, sa) and then about z (c, s)."""
    wy, wz = turn_forward(ca, sa, wy, wz)
    vy, vz = turn_forward(ca, sa, vy, vz)
    wx, wy = turn_forward(c, s, wx, wy)
    vx, vy = turn_forward(c, s, vx, vy)
    return wx, wy, wz, vx, vy, vz


@in_place
def bias_wrench(
    m: Any, hx: Any, hy: Any, hz: Any, ixx: Any, iyy: Any, izz: Any, ixy: Any, ixz: Any, iyz: Any,
    wx: Any, wy: Any, wz: Any, vx: Any, vy: Any, vz: Any,
) -> Any:  # fmt: skip
    """Bias wrench of a rigid body: its twist × its momentum; h: first moments, I: inertia about the origin."""
    nx = ixx * wx + ixy * wy + ixz * wz + (hy * vz - hz * vy)
    ny = ixy * wx + iyy * wy + iyz * wz + (hz * vx - hx * vz)
    nz = ixz * wx + iyz * wy + izz * wz + (hx * vy - hy * vx)
    fx = m * vx + (wy * hz - wz * hy)
    fy = m * vy + (wz * hx - wx * hz)
    fz = m * vz + (wx * hy - wy * hx)
    return (
        (wy * nz - wz * ny) + (vy * fz - vz * fy),
        (wz * nx - wx * nz) + (vz * fx - vx * fz),
        (wx * ny - wy * nx) + (vx * fy - vy * fx),
        wy * fz - wz * fy,
        wz * fx - wx * fz,
        wx * fy - wy * fx,
    )


@in_place
def without_joint(gain: Any, column: Any, angular: Any, mixed: Any, linear: Any) -> Any:
    """An articulated inertia less U D⁻¹ Uᵀ; column: U = inertia times axis, gain: U D⁻¹."""
    k1, k2, k3, k4, k5, k6 = gain
    u1, u2, u3, u4, u5, u6 = column
    axx, ayy, azz, axy, axz, ayz = angular
    bxx, bxy, bxz, byx, byy, byz, bzx, bzy, bzz = mixed
    mxx, myy, mzz, mxy, mxz, myz = linear
    return (
        (axx - k1 * u1, ayy - k2 * u2, azz - k3 * u3, axy - k1 * u2, axz - k1 * u3, ayz - k2 * u3),
        (
            bxx - k1 * u4, bxy - k1 * u5, bxz - k1 * u6,
            byx - k2 * u4, byy - k2 * u5, byz - k2 * u6,
            bzx - k3 * u4, bzy - k3 * u5, bzz - k3 * u6,
        ),
        (mxx - k4 * u4, myy - k5 * u5, mzz - k6 * u6, mxy - k4 * u5, mxz - k4 * u6, myz - k5 * u6),
    )  # fmt: skip
