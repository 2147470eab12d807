"""Written by ``python -m tautline.lumped.derive``: do not edit. Derivation f2b66341793596ca."""

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import cos, sin, sqrt


@kernel
def body_residual(m, J, Jt, ma, W, k1, k2, g1, g2, g3, u, v, th, sd, ud, vd, thd, sdd, udd, vdd, thdd):
    """M a - F of one body on an arc, by s, u, v, theta."""
    c0 = (k1*k1)
    c1 = (k2*k2)
    c2 = c0*m
    c3 = c1*m
    c4 = 2.0*m
    c5 = k1*u
    c6 = c4*c5
    c7 = k2*v
    c8 = c4*c7
    c9 = W*g3
    c10 = c4*sd
    c11 = k1*ud
    c12 = k2*vd
    c13 = c2*u
    c14 = 2.0*sd
    c15 = c3*v
    c16 = m + ma
    c17 = (sd*sd)
    c18 = c17*k1*m
    r0 = -c10*c11 - c10*c12 + c11*c8*sd + c12*c6*sd + c13*c14*ud + c14*c15*vd + c5*c9 + c7*c9 - c9 + sdd*(Jt*c0 + Jt*c1 + c2*(u*u) + c3*(v*v) + c6*c7 - c6 - c8 + m)
    r1 = -W*g1 - c13*c17 + c16*udd + c17*k1*m - c18*c7
    r2 = -W*g2 - c15*c17 + c16*vdd + c17*k2*m - c18*k2*u
    r3 = J*thdd
    return r0, r1, r2, r3


@kernel
def body_mass(m, J, Jt, ma, W, k1, k2, u, v, th, mass):
    """Entries of M (4, 4) of one body on an arc that are not always zero."""
    c0 = (k1*k1)
    c1 = (k2*k2)
    c2 = 2.0*m
    c3 = c2*k1*u
    c4 = k2*v
    c5 = m + ma
    mass[0, 0] = Jt*c0 + Jt*c1 + c0*m*(u*u) + c1*m*(v*v) - c2*c4 + c3*c4 - c3 + m
    mass[1, 1] = c5
    mass[2, 2] = c5
    mass[3, 3] = J


@kernel
def body_tangent(m, J, Jt, ma, W, k1, k2, g1, g2, g3, u, v, th, sd, ud, vd, thd, sdd, udd, vdd, thdd, stiffness, damping):
    """dr/dq and dr/dv (4, 4) of one body on an arc."""
    c0 = k1*u
    c1 = k2*v
    c2 = c0 + c1 - 1.0
    c3 = W*g3
    c4 = 2.0*m
    c5 = c2*c4
    c6 = k1*ud
    c7 = c4*sd
    c8 = k2*vd
    c9 = c3 + c5*sdd + c6*c7 + c7*c8
    c10 = (k1*k1)
    c11 = m*(sd*sd)
    c12 = -c11*k1*k2
    c13 = (k2*k2)
    c14 = c5*sd
    c15 = -c2*c7
    stiffness[0, 0] = W*c2*(g1*k1 + g2*k2)
    stiffness[0, 1] = c9*k1
    stiffness[0, 2] = c9*k2
    stiffness[0, 3] = 0.0
    stiffness[1, 0] = c3*k1
    stiffness[1, 1] = -c10*c11
    stiffness[1, 2] = c12
    stiffness[1, 3] = 0.0
    stiffness[2, 0] = c3*k2
    stiffness[2, 1] = c12
    stiffness[2, 2] = -c11*c13
    stiffness[2, 3] = 0.0
    stiffness[3, 0] = 0.0
    stiffness[3, 1] = 0.0
    stiffness[3, 2] = 0.0
    stiffness[3, 3] = 0.0
    damping[0, 0] = c4*(c0*c8 + c1*c6 + c10*u*ud + c13*v*vd - c6 - c8)
    damping[0, 1] = c14*k1
    damping[0, 2] = c14*k2
    damping[0, 3] = 0.0
    damping[1, 0] = c15*k1
    damping[1, 1] = 0.0
    damping[1, 2] = 0.0
    damping[1, 3] = 0.0
    damping[2, 0] = c15*k2
    damping[2, 1] = 0.0
    damping[2, 2] = 0.0
    damping[2, 3] = 0.0
    damping[3, 0] = 0.0
    damping[3, 1] = 0.0
    damping[3, 2] = 0.0
    damping[3, 3] = 0.0


@kernel
def body_kinetic_energy(m, J, Jt, ma, W, k1, k2, u, v, th, sd, ud, vd, thd):
    """Kinetic energy of one body on an arc, J."""
    c0 = (k1*k1)
    c1 = (k2*k2)
    c2 = 2.0*m
    c3 = c2*k1*u
    c4 = k2*v
    c5 = m + ma
    energy = (1.0/2.0)*J*(thd*thd) + (1.0/2.0)*c5*(ud*ud) + (1.0/2.0)*c5*(vd*vd) + (1.0/2.0)*(sd*sd)*(Jt*c0 + Jt*c1 + c0*m*(u*u) + c1*m*(v*v) - c2*c4 + c3*c4 - c3 + m)
    return energy


@kernel
def eccentric_body_residual(m, J, Jt, ma, W, e1, e2, k1, k2, g1, g2, g3, u, v, th, sd, ud, vd, thd, sdd, udd, vdd, thdd):
    """M a - F of one body on an arc, its centre of gravity off the axis, by s, u, v, theta."""
    c0 = cos(th)
    c1 = c0*k1
    c2 = sin(th)
    c3 = c2*k2
    c4 = c2*k1
    c5 = c0*k2
    c6 = k1*u
    c7 = k2*v
    c8 = c1*e1
    c9 = c3*e1
    c10 = c5*e2
    c11 = c4*e2
    c12 = W*g3
    c13 = m*sd
    c14 = 2.0*c13
    c15 = c14*ud
    c16 = c15*k1
    c17 = c14*vd
    c18 = c17*k2
    c19 = (k1*k1)
    c20 = c15*c19
    c21 = (k2*k2)
    c22 = c17*c21
    c23 = c14*thd
    c24 = c23*e1
    c25 = c2*e2
    c26 = c0*e1
    c27 = c2*e1
    c28 = c23*e2
    c29 = c1*c28
    c30 = c28*c3
    c31 = c0*e2
    c32 = (c0*c0)
    c33 = e1*e2
    c34 = c23*c33
    c35 = c19*c34
    c36 = (c2*c2)
    c37 = c21*c34
    c38 = c19*c23
    c39 = c38*u
    c40 = c3*e2
    c41 = c21*c23
    c42 = c41*v
    c43 = (e1*e1)
    c44 = c23*k1
    c45 = c44*k2
    c46 = c43*c45
    c47 = (e2*e2)
    c48 = c45*c47
    c49 = c0*c2
    c50 = c43*c49
    c51 = c47*c49
    c52 = c1*e2
    c53 = c9*v
    c54 = c8*u
    c55 = W*g1
    c56 = m + ma
    c57 = c27 + c31
    c58 = (sd*sd)
    c59 = (thd*thd)
    c60 = c59*m
    c61 = c58*m
    c62 = c19*c61
    c63 = c62*u
    c64 = (c0*c0*c0)
    c65 = c64*e1
    c66 = c61*k1
    c67 = (c2*c2*c2)
    c68 = c67*e1
    c69 = c66*k2
    c70 = c36*c62
    c71 = c64*e2
    c72 = c61*k2
    c73 = c36*c72
    c74 = W*g2
    c75 = -c25 + c26
    c76 = c21*c61
    c77 = c76*v
    c78 = c32*c76
    c79 = c36*c76
    c80 = c61*e1
    c81 = c61*e2
    c82 = c1*c81
    c83 = c3*c81
    c84 = c43*c69
    c85 = c47*c69
    r0 = c10*c12 - c11*c12 + c12*c6 + c12*c7 + c12*c8 + c12*c9 - c12 - 8.0*c13*c40*c8*thd + c15*c52*k2 + c16*c7 + c16*c9 - c16 - c17*c40*k1 + c18*c6 + c18*c8 - c18 - c20*c25 + c20*c26 + c20*u + c22*c27 + c22*c31 + c22*v + c23*c54*k2 + c24*c4 - c24*c5 - c25*c42 + c26*c42 - c27*c39 - c29*c7 + c29 - c30*c6 + c30 - c31*c39 - c32*c35 + c32*c37 + c32*c46 - c32*c48 + c35*c36 - c36*c37 - c36*c46 + c36*c48 - c38*c50 + c38*c51 + c41*c50 - c41*c51 - c44*c53 + sdd*(Jt*((c1 + c3)*(c1 + c3)) + Jt*((c4 - c5)*(c4 - c5)) + m*((c10 - c11 + c6 + c7 + c8 + c9 - 1.0)*(c10 - c11 + c6 + c7 + c8 + c9 - 1.0)))
    r1 = c19*c2*c32*c58*e2*m + c19*c58*c67*e2*m + c2*c59*e2*m - c26*c60 - c26*c70 - c32*c66*c9 - c52*c73 - c55 + c56*udd - c57*m*thdd + c58*k1*m - c62*c65 - c63 - c66*c7 - c68*c69 - c69*c71
    r2 = c2*c32*c58*e2*k1*k2*m - c27*c60 - c27*c78 - c31*c60 - c31*c79 + c56*vdd + c58*c67*e2*k1*k2*m + c58*k2*m - c6*c72 - c65*c69 - c68*c76 - c71*c76 - c73*c8 - c74 + c75*m*thdd - c77
    r3 = c25*c74 + c25*c77 - c26*c74 - c26*c77 + c27*c55 + c27*c63 + c31*c55 + c31*c63 + c32*c33*c62 - c32*c84 + c32*c85 - c33*c70 - c33*c78 + c33*c79 + c36*c84 - c36*c85 - c4*c80 + c5*c80 + c50*c62 - c50*c76 - c51*c62 + c51*c76 + c53*c66 - c54*c72 - c57*m*udd + c6*c83 + c7*c82 + c75*m*vdd + 4.0*c8*c83 - c82 - c83 + thdd*(J + m*(c43 + c47))
    return r0, r1, r2, r3


@kernel
def eccentric_body_mass(m, J, Jt, ma, W, e1, e2, k1, k2, u, v, th, mass):
    """Entries of M (4, 4) of one body on an arc, its centre of gravity off the axis that are not always zero."""
    c0 = cos(th)
    c1 = c0*k1
    c2 = sin(th)
    c3 = c2*k2
    c4 = c2*k1
    c5 = c0*k2
    c6 = m + ma
    c7 = -m*(c0*e2 + c2*e1)
    c8 = m*(c0*e1 - c2*e2)
    mass[0, 0] = Jt*((c1 + c3)*(c1 + c3)) + Jt*((c4 - c5)*(c4 - c5)) + m*((c1*e1 + c3*e1 - c4*e2 + c5*e2 + k1*u + k2*v - 1.0)*(c1*e1 + c3*e1 - c4*e2 + c5*e2 + k1*u + k2*v - 1.0))
    mass[1, 1] = c6
    mass[1, 3] = c7
    mass[2, 2] = c6
    mass[2, 3] = c8
    mass[3, 1] = c7
    mass[3, 2] = c8
    mass[3, 3] = J + m*((e1*e1) + (e2*e2))


@kernel
def eccentric_body_tangent(m, J, Jt, ma, W, e1, e2, k1, k2, g1, g2, g3, u, v, th, sd, ud, vd, thd, sdd, udd, vdd, thdd, stiffness, damping):
    """dr/dq and dr/dv (4, 4) of one body on an arc, its centre of gravity off the axis."""
    c0 = cos(th)
    c1 = c0*e1
    c2 = c1*k1
    c3 = sin(th)
    c4 = c3*e1
    c5 = c4*k2
    c6 = c0*e2
    c7 = c6*k2
    c8 = c3*e2
    c9 = c8*k1
    c10 = k1*u
    c11 = k2*v
    c12 = c10 + c11 - 1.0
    c13 = c12 + c2 + c5 + c7 - c9
    c14 = W*g3
    c15 = 2.0*m
    c16 = c13*c15
    c17 = c16*sdd
    c18 = k1*ud
    c19 = c15*sd
    c20 = c18*c19
    c21 = k2*vd
    c22 = c19*c21
    c23 = c4*k1
    c24 = c23*thd
    c25 = c6*k1
    c26 = c25*thd
    c27 = c8*k2
    c28 = c27*thd
    c29 = c1*k2
    c30 = c29*thd
    c31 = c14 + c17 - c19*c24 - c19*c26 - c19*c28 + c19*c30 + c20 + c22
    c32 = c23 + c25 + c27 - c29
    c33 = (k2*k2)
    c34 = (e1*e1)
    c35 = (k1*k1)
    c36 = (c3*c3)
    c37 = (c0*c0)
    c38 = (e2*e2)
    c39 = c35*ud
    c40 = c19*c39
    c41 = c19*thd
    c42 = c33*vd
    c43 = c34*c37
    c44 = c33*c34
    c45 = c35*c36
    c46 = c37*c38
    c47 = c35*u
    c48 = c33*v
    c49 = c41*c48
    c50 = e1*e2
    c51 = c37*c50
    c52 = k1*k2
    c53 = 8.0*m*sd*thd
    c54 = c52*c53
    c55 = c1*c8
    c56 = c0*c3
    c57 = c34*c56
    c58 = (sd*sd)
    c59 = c58*m
    c60 = c35*c59
    c61 = c59*k1
    c62 = c61*k2
    c63 = -c62
    c64 = c1 - c8
    c65 = (thd*thd)
    c66 = (c3*c3*c3)
    c67 = c66*e1
    c68 = c35*c58
    c69 = (c0*c0*c0)
    c70 = c69*e2
    c71 = c66*e2
    c72 = c58*k2
    c73 = c69*e1
    c74 = c73*k1
    c75 = c2*c36
    c76 = c33*c59
    c77 = c4 + c6
    c78 = c33*c58
    c79 = c67*k2
    c80 = c58*k1
    c81 = c70*k2
    c82 = c37*c5
    c83 = c36*c7
    c84 = c77*m
    c85 = W*g1
    c86 = W*g2
    c87 = c59*c9
    c88 = c34*c36
    c89 = c36*c38
    c90 = c2*c59
    c91 = c5*c59
    c92 = c59*c7
    c93 = c60*u
    c94 = c76*v
    c95 = 4.0*c62
    c96 = 4.0*c55
    c97 = c38*c56
    c98 = c36*c52
    c99 = c35*c56
    c100 = c35*c51
    c101 = c33*c36*c50
    c102 = c4*c47
    c103 = c47*c6
    c104 = c48*c8
    c105 = c34*c98
    c106 = c46*c52
    c107 = c34*c99
    c108 = c33*c97
    c109 = 4.0*c2
    c110 = c16*sd
    c111 = -c0*c3*c33*c34 - c0*c3*c35*c38 - c0*c33*e1*v - c0*e1*k1*k2*u - c0*e2*k1 + c10*c27 + c100 + c101 + c102 + c103 + c104 + c105 + c106 + c107 + c108 + c109*c27 + c11*c23 + c11*c25 + c29 - c3*e1*k1 - c3*e2*k2 - c33*c37*e1*e2 - c34*c37*k1*k2 - c35*c36*e1*e2 - c36*c38*k1*k2
    c112 = c19*(-c12 + c3*c37*e2*k1 + c66*e2*k1 - c74 - c75 - c79 - c81 - c82 - c83)
    stiffness[0, 0] = W*c13*(g1*k1 + g2*k2)
    stiffness[0, 1] = c31*k1
    stiffness[0, 2] = c31*k2
    stiffness[0, 3] = W*c0*e1*g3*k2 + 8.0*c0*c3*c35*e1*e2*m*sd*thd + 8.0*c0*c3*c38*k1*k2*m*sd*thd + 2.0*c0*c33*e1*m*sd*vd + 2.0*c0*e1*k1*k2*m*sd*ud + 2.0*c0*e1*k1*m*sd*thd + 2.0*c0*e2*k2*m*sd*thd - c1*c41*c47 - c10*c41*c5 - c10*c41*c7 - c11*c2*c41 - c14*c23 - c14*c25 - c14*c27 - c17*c32 - c19*c42*c8 - c20*c27 - c22*c23 - c22*c25 + 2.0*c3*c35*e2*m*sd*thd*u + 2.0*c3*e1*k2*m*sd*thd + 2.0*c3*e2*k1*k2*m*sd*thd*v + 2.0*c33*c34*c37*m*sd*thd + 2.0*c33*c36*c38*m*sd*thd - c33*c41*c46 - c33*c53*c55 + 2.0*c34*c35*c36*m*sd*thd + 2.0*c35*c37*c38*m*sd*thd - c35*c41*c43 - c36*c41*c44 + 8.0*c36*e1*e2*k1*k2*m*sd*thd - c38*c41*c45 - c4*c40 - c4*c49 - c40*c6 - c41*c9 - c49*c6 - c51*c54 - c54*c57
    stiffness[1, 0] = c14*k1
    stiffness[1, 1] = -c60
    stiffness[1, 2] = c63
    stiffness[1, 3] = m*(c36*c6*c68 + c37*c4*c68 + c37*c72*c9 + c4*c65 + c6*c65 - c64*thdd + c67*c68 + c68*c70 + c71*c72*k1 - c72*c74 - c72*c75)
    stiffness[2, 0] = c14*k2
    stiffness[2, 1] = c63
    stiffness[2, 2] = -c76
    stiffness[2, 3] = m*(-c1*c36*c78 - c1*c65 + c37*c78*c8 + c65*c8 + c71*c78 - c73*c78 - c77*thdd + c79*c80 + c80*c81 + c80*c82 + c80*c83)
    stiffness[3, 0] = c14*(c64*k2 - c77*k1)
    stiffness[3, 1] = c32*c61
    stiffness[3, 2] = c32*c59*k2
    stiffness[3, 3] = c1*c85 + c1*c93 + c10*c91 + c10*c92 - c11*c87 + c11*c90 - c36*c50*c95 + c4*c86 + c4*c94 + c43*c60 - c43*c76 - c46*c60 + c46*c76 + c51*c95 + c57*c95 + c6*c86 + c6*c94 - c60*c88 + c60*c89 - c60*c96 - c64*m*udd + c76*c88 - c76*c89 + c76*c96 - c8*c85 - c8*c93 - c84*vdd + c87 - c90 - c91 - c92 - c95*c97
    damping[0, 0] = c15*(c1*c39 + c1*c48*thd + c10*c21 - c10*c28 + c10*c30 - c100*thd - c101*thd - c102*thd - c103*thd - c104*thd - c105*thd - c106*thd - c107*thd - c108*thd - c109*c28 + c11*c18 - c11*c24 - c11*c26 + c18*c5 + c18*c7 - c18 + c2*c21 - c21*c9 - c21 + c24 + c26 + c28 - c30 + c33*c51*thd + c38*c98*thd + c38*c99*thd - c39*c8 + c39*u + c4*c42 + c42*c6 + c42*v + c43*c52*thd + c44*c56*thd + c45*c50*thd)
    damping[0, 1] = c110*k1
    damping[0, 2] = c110*k2
    damping[0, 3] = -c111*c19
    damping[1, 0] = c112*k1
    damping[1, 1] = 0.0
    damping[1, 2] = 0.0
    damping[1, 3] = -c15*c64*thd
    damping[2, 0] = c112*k2
    damping[2, 1] = 0.0
    damping[2, 2] = 0.0
    damping[2, 3] = -2.0*c84*thd
    damping[3, 0] = c111*c19
    damping[3, 1] = 0.0
    damping[3, 2] = 0.0
    damping[3, 3] = 0.0


@kernel
def eccentric_body_kinetic_energy(m, J, Jt, ma, W, e1, e2, k1, k2, u, v, th, sd, ud, vd, thd):
    """Kinetic energy of one body on an arc, its centre of gravity off the axis, J."""
    c0 = cos(th)
    c1 = c0*e1
    c2 = sin(th)
    c3 = c2*e2
    c4 = m*(c1 - c3)
    c5 = c2*e1
    c6 = c0*e2
    c7 = m*(c5 + c6)
    c8 = m + ma
    energy = (1.0/2.0)*(sd*sd)*(Jt*((c0*k1 + c2*k2)*(c0*k1 + c2*k2)) + Jt*((-c0*k2 + c2*k1)*(-c0*k2 + c2*k1)) + m*((c1*k1 - c3*k1 + c5*k2 + c6*k2 + k1*u + k2*v - 1.0)*(c1*k1 - c3*k1 + c5*k2 + c6*k2 + k1*u + k2*v - 1.0))) + (1.0/2.0)*thd*(c4*vd - c7*ud + thd*(J + m*((e1*e1) + (e2*e2)))) - 1.0/2.0*ud*(c7*thd - c8*ud) + (1.0/2.0)*vd*(c4*thd + c8*vd)
    return energy


@kernel
def chord_gradient(x1, u1, v1, x2, u2, v2, f11, f21, k11, k21, f12, f22, k12, k22):
    """Return the chord beyond the unstretched length, m, and its gradient (6,)."""
    c0 = f11 - f12
    c1 = (1.0/2.0)*u1 + (1.0/2.0)*u2
    c2 = f21 - f22
    c3 = (1.0/2.0)*v1 + (1.0/2.0)*v2
    c4 = (1.0/2.0)*c0
    c5 = (1.0/2.0)*c2
    value = c0*c1 + c2*c3 - x1 + x2
    d0 = c1*k11 + c3*k21 - 1.0
    d1 = c4
    d2 = c5
    d3 = -c1*k12 - c3*k22 + 1.0
    d4 = c4
    d5 = c5
    return value, (d0, d1, d2, d3, d4, d5)


@kernel
def chord_hessian(x1, u1, v1, x2, u2, v2, f11, f21, k11, k21, f12, f22, k12, k22, hessian):
    """Upper triangle of the Hessian (6, 6) of the chord beyond the unstretched length, m, where it is not always zero."""
    c0 = (1.0/2.0)*k11
    c1 = (1.0/2.0)*k21
    c2 = -1.0/2.0*k12
    c3 = -1.0/2.0*k22
    hessian[0, 1] = c0
    hessian[0, 2] = c1
    hessian[0, 4] = c0
    hessian[0, 5] = c1
    hessian[1, 3] = c2
    hessian[2, 3] = c3
    hessian[3, 4] = c2
    hessian[3, 5] = c3


@kernel
def link_stretch_gradient(l0, a, du, dv):
    """Return the stretch of a link, m, and its gradient (3,)."""
    c0 = a + l0
    c1 = (du*du) + (dv*dv)
    root1 = sqrt((c0*c0) + c1)
    over1 = 1.0/root1
    c2 = 1.0/(l0 + root1)
    c3 = c2*((a*a) + 2.0*a*l0 + c1)
    c4 = c2*(-c3*over1 + 2.0)
    value = c3
    d0 = c0*c4
    d1 = c4*du
    d2 = c4*dv
    return value, (d0, d1, d2)


@kernel
def link_stretch_hessian(l0, a, du, dv, hessian):
    """Upper triangle of the Hessian (3, 3) of the stretch of a link, m, where it is not always zero."""
    c0 = a + l0
    c1 = (c0*c0)
    c2 = (du*du)
    c3 = (dv*dv)
    c4 = c2 + c3
    c5 = c1 + c4
    root1 = sqrt(c5)
    over1 = 1.0/root1
    c6 = l0 + root1
    c7 = 1.0/c6
    c8 = 4.0*over1
    c9 = c1*c7
    c10 = (a*a) + 2.0*a*l0 + c4
    c11 = c10*(over1*over1*over1)
    c12 = 1.0/(c6*c6)
    c13 = 2.0/c5
    c14 = c10*c12*c13
    c15 = c10*c7
    c16 = -c15*over1 + 2.0
    c17 = c11 + c13*c15 - c8
    c18 = c0*c12*c17
    c19 = c2*c7
    c20 = c3*c7
    hessian[0, 0] = c7*(c1*c14 + c11*c9 + c16 - c8*c9)
    hessian[0, 1] = c18*du
    hessian[0, 2] = c18*dv
    hessian[1, 1] = c7*(c11*c19 + c14*c2 + c16 - c19*c8)
    hessian[1, 2] = c12*c17*du*dv
    hessian[2, 2] = c7*(c11*c20 + c14*c3 + c16 - c20*c8)


@kernel
def bend_gradient(w1, w2, w3, w4, w5, w6, w7, w8):
    """Return the bending energy over EI / lb, and its gradient (8,)."""
    c0 = (w4*w4)
    c1 = (w5*w5)
    c2 = (w6*w6)
    root1 = sqrt(c0 + c1 + c2)
    over1 = 1.0/root1
    c3 = (w1*w1)
    c4 = (w2*w2)
    c5 = (w3*w3)
    root2 = sqrt(c3 + c4 + c5)
    over2 = 1.0/root2
    c6 = over1*w4 - over2*w1
    c7 = over1*w5 - over2*w2 + w7
    c8 = over1*w6 - over2*w3 + w8
    c9 = (over2*over2)
    c10 = c9*w1
    c11 = c10*w2
    c12 = c8*w3
    c13 = c9*w2
    c14 = (over1*over1)
    c15 = c14*w4
    c16 = c15*w5
    c17 = c8*w6
    c18 = c14*w5
    value = (1.0/2.0)*(c6*c6) + (1.0/2.0)*(c7*c7) + (1.0/2.0)*(c8*c8)
    d0 = over2*(c10*c12 + c11*c7 + c6*(c3*c9 - 1.0))
    d1 = over2*(c11*c6 + c12*c13 + c7*(c4*c9 - 1.0))
    d2 = over2*(c10*c6*w3 + c13*c7*w3 + c8*(c5*c9 - 1.0))
    d3 = -over1*(c15*c17 + c16*c7 + c6*(c0*c14 - 1.0))
    d4 = -over1*(c16*c6 + c17*c18 + c7*(c1*c14 - 1.0))
    d5 = -over1*(c15*c6*w6 + c18*c7*w6 + c8*(c14*c2 - 1.0))
    d6 = c7
    d7 = c8
    return value, (d0, d1, d2, d3, d4, d5, d6, d7)


@kernel
def bend_hessian(w1, w2, w3, w4, w5, w6, w7, w8, hessian):
    """Upper triangle of the Hessian (8, 8) of the bending energy over EI / lb, where it is not always zero."""
    c0 = (w1*w1)
    c1 = (w2*w2)
    c2 = (w3*w3)
    c3 = c0 + c1 + c2
    root1 = sqrt(c3)
    over1 = 1.0/root1
    c4 = (w4*w4)
    c5 = (w5*w5)
    c6 = (w6*w6)
    c7 = c4 + c5 + c6
    root2 = sqrt(c7)
    over2 = 1.0/root2
    c8 = (over1*over1)
    c9 = c0*c8
    c10 = c9 - 1.0
    c11 = 3.0*(over1*over1*over1*over1*over1)
    c12 = c0*c11
    c13 = -over1*w2 + over2*w5 + w7
    c14 = c13*w2
    c15 = -over1*w3 + over2*w6 + w8
    c16 = c15*w3
    c17 = over1*w1 - over2*w4
    c18 = (over1*over1*over1)
    c19 = c18*w1
    c20 = c17*c19
    c21 = c15*c18
    c22 = c21*w3
    c23 = 1.0/(c3*c3*c3)
    c24 = c0*c23
    c25 = c1*c24 + c22
    c26 = c13*c18
    c27 = c26*w2
    c28 = c2*c24 + c27
    c29 = (over1*over1*over1*over1)
    c30 = w1*w2
    c31 = c29*c30
    c32 = c1*c8
    c33 = c32 - 1.0
    c34 = c2*c23
    c35 = c18*w2
    c36 = c17*(3.0*c9 - 1.0)
    c37 = c11*w1
    c38 = c1*c37
    c39 = c11*c16
    c40 = w1*w3
    c41 = c29*c40
    c42 = c2*c8 - 1.0
    c43 = c15*c2
    c44 = c11*c30*w3
    c45 = (over2*over2)
    c46 = c4*c45
    c47 = c46 - 1.0
    c48 = c30*c8
    c49 = c45*w4
    c50 = c49*w5
    c51 = c48*c50
    c52 = c40*c8
    c53 = c49*w6
    c54 = c52*c53
    c55 = over1*over2
    c56 = c45*c5
    c57 = c56 - 1.0
    c58 = c10*c49
    c59 = w5*w6
    c60 = c45*c59
    c61 = c45*c6 - 1.0
    c62 = c61*c8
    c63 = c1*c34 - c20
    c64 = w2*w3
    c65 = c29*c64
    c66 = c64*c8
    c67 = c60*c66
    c68 = c35*w3
    c69 = (over2*over2*over2)
    c70 = c69*w4
    c71 = c17*c70
    c72 = 3.0*(over2*over2*over2*over2*over2)
    c73 = c4*c72
    c74 = c13*w5
    c75 = c15*w6
    c76 = 1.0/(c7*c7*c7)
    c77 = c4*c76
    c78 = c15*c69
    c79 = c78*w6
    c80 = c5*c77 - c79
    c81 = c13*c69
    c82 = c81*w5
    c83 = c6*c77 - c82
    c84 = (over2*over2*over2*over2)
    c85 = w4*w5
    c86 = c84*c85
    c87 = c6*c76
    c88 = c17*c69*(3.0*c46 - 1.0)
    c89 = c72*w4
    c90 = c5*c89
    c91 = c59*c89
    c92 = w4*w6
    c93 = c84*c92
    c94 = c15*c6
    c95 = c5*c87 + c71
    c96 = c59*c84
    c97 = c17*c89
    c98 = -c59*c69
    hessian[0, 0] = (c10*c10)*c8 + 3.0*c10*c20 - c12*c14 - c12*c16 + c25 + c28
    hessian[0, 1] = c10*c31 - c13*c38 + c26*w1 + c30*c34 - c30*c39 + c31*c33 + c35*c36
    hessian[0, 2] = c1*c23*c40 + c10*c41 - c13*c44 + c18*c36*w3 + c21*w1 - c37*c43 + c41*c42
    hessian[0, 3] = -c55*(c10*c47 + c51 + c54)
    hessian[0, 4] = -c55*(c48*c57 + c52*c60 + c58*w5)
    hessian[0, 5] = -c55*(c40*c62 + c48*c60 + c58*w6)
    hessian[0, 6] = c19*w2
    hessian[0, 7] = c19*w3
    hessian[1, 1] = -c1*c39 + c17*c38 + c25 - 3.0*c27*c33 + (c33*c33)*c8 + c63
    hessian[1, 2] = -c11*c43*w2 + c17*c44 + c21*w2 + c24*c64 - c26*w3*(3.0*c32 - 1.0) + c33*c65 + c42*c65
    hessian[1, 3] = -c55*(c33*c50 + c47*c48 + c53*c66)
    hessian[1, 4] = -c55*(c33*c57 + c51 + c67)
    hessian[1, 5] = -c55*(c33*c60 + c48*c53 + c62*c64)
    hessian[1, 6] = c33*over1
    hessian[1, 7] = c68
    hessian[2, 2] = -c11*c14*c2 + c17*c2*c37 - 3.0*c22*c42 + c28 + (c42*c42)*c8 + c63
    hessian[2, 3] = -c55*(c42*c53 + c47*c52 + c50*c66)
    hessian[2, 4] = -c55*(c42*c60 + c50*c52 + c57*c66)
    hessian[2, 5] = -c55*(c42*c61 + c54 + c67)
    hessian[2, 6] = c68
    hessian[2, 7] = c42*over1
    hessian[3, 3] = c45*(c47*c47) - 3.0*c47*c71 + c73*c74 + c73*c75 + c80 + c83
    hessian[3, 4] = c13*c90 + c15*c91 + c47*c86 + c57*c86 - c81*w4 + c85*c87 - c88*w5
    hessian[3, 5] = c13*c91 + c47*c93 + c5*c76*c92 + c61*c93 - c78*w4 - c88*w6 + c89*c94
    hessian[3, 6] = -c70*w5
    hessian[3, 7] = -c70*w6
    hessian[4, 4] = -c17*c90 + c45*(c57*c57) + c5*c72*c75 + 3.0*c57*c82 + c80 + c95
    hessian[4, 5] = c57*c96 + c59*c77 - c59*c97 + c61*c96 + c72*c94*w5 - c78*w5 + c81*w6*(3.0*c56 - 1.0)
    hessian[4, 6] = -c57*over2
    hessian[4, 7] = c98
    hessian[5, 5] = c45*(c61*c61) + c6*c72*c74 - c6*c97 + 3.0*c61*c79 + c83 + c95
    hessian[5, 6] = c98
    hessian[5, 7] = -c61*over2
    hessian[6, 6] = 1.0
    hessian[7, 7] = 1.0


@kernel
def link_and_bend_gradient(l0, a, du, dv, w4, w5, w6, w7, w8):
    """Return a link's stretch, m, its gradient (3,), and that (8,) of the energy of the bend below over EI / lb."""
    c0 = a + l0
    c1 = (c0*c0)
    c2 = (du*du)
    c3 = (dv*dv)
    c4 = c2 + c3
    root1 = sqrt(c1 + c4)
    over1 = 1.0/root1
    c5 = (w4*w4)
    c6 = (w5*w5)
    c7 = (w6*w6)
    root2 = sqrt(c5 + c6 + c7)
    over2 = 1.0/root2
    c8 = 1.0/(l0 + root1)
    c9 = c8*((a*a) + 2.0*a*l0 + c4)
    c10 = c8*(-c9*over1 + 2.0)
    c11 = (over1*over1)
    c12 = c0*over1 - over2*w4
    c13 = -du*over1 + over2*w5 + w7
    c14 = c0*c11
    c15 = c14*du
    c16 = -dv*over1 + over2*w6 + w8
    c17 = c16*dv
    c18 = c11*du
    c19 = (over2*over2)
    c20 = c19*w4
    c21 = c16*w6
    c22 = c19*w5
    value = c9
    d0 = c0*c10
    d1 = c10*du
    d2 = c10*dv
    b0 = over1*(-c12*(c1*c11 - 1.0) + c13*c15 + c14*c17)
    b1 = over1*(-c12*c15 + c13*(c11*c2 - 1.0) + c17*c18)
    b2 = over1*(-c12*c14*dv + c13*c18*dv + c16*(c11*c3 - 1.0))
    b3 = over2*(c12*(c19*c5 - 1.0) - c13*c20*w5 - c20*c21)
    b4 = over2*(c12*c19*w4*w5 - c13*(c19*c6 - 1.0) - c21*c22)
    b5 = over2*(c12*c19*w4*w6 - c13*c22*w6 - c16*(c19*c7 - 1.0))
    b6 = c13
    b7 = c16
    return value, (d0, d1, d2), (b0, b1, b2, b3, b4, b5, b6, b7)
