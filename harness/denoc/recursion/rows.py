"""Where each quantity of a body stands in its row of the packed array: constants first, then workspace.

One row a body, one body a movable joint; row 0 is the base. The joint's axis is the z axis of the body's own frame.
Workspace vectors are in base axes, moments and inertias about the body's own origin: no rotation of an articulated
inertia is ever needed, and nothing grows with the distance from the base.
"""

# Constants of the mechanism.
PLACE = 0  # rotation (9) from body axes at zero position to the parent body's axes (to the section's, on a beam)
OFFSET = 9  # origin (3) in the parent body's axes [m]
MASS = 12  # [kg]
MOMENT = 13  # mass times centre of mass (3), body axes [kg·m]
INERTIA = 16  # about the origin, body axes: xx xy xz yy yz zz [kg·m²]
ARMATURE = 22
DAMPING = 23
STIFFNESS = 24
REST = 25
EXTERNAL = 26  # external moment (3) and force (3) on the body at its origin, base axes

# Workspace.
TURN = 32  # R: body axes to base axes (9); its third column is the joint's axis z
REACH = 41  # r: parent's origin to own origin (3)
SPIN = 44  # ω (3)
BIAS = 47  # angular and linear acceleration due to velocity alone, relative to the parent's motion (6)
J = 53  # articulated (or composite) inertia [J B; Bᵀ M] of (angular, linear): J (6, symmetric)
B = 59  # (9)
M = 68  # (6, symmetric)
FORCE = 74  # bias moment (3) and force (3)
COLUMN = 80  # U of U D Uᵀ: articulated inertia times joint axis (6)
PIVOT = 86  # 1 / D
DRIVE = 87  # what is left to accelerate the joint
ACCELERATION = 88  # angular, linear acceleration of the origin, gravity included as -g at the base (6)
POSITION = 94  # of the origin in base coordinates (3)
VELOCITY = 97  # of the origin (3)
WIDTH = 104

# Columns of the integer array.
PARENT = 0  # row of the parent body
KIND = 1  # FIXED, REVOLUTE, PRISMATIC
FIRST = 2  # index of the body's first coordinate
MODES = 3  # number m of elastic coordinates, which follow the joint's
POINTS = 4  # number of points that carry the beam's mass
BEAM = 5  # where the beam's constants begin in the beam array
STATION = 6  # where the constants of the section this body rides on begin, -1 if the parent is rigid there
EXTENDED = 7  # where the body's elastic workspace begins
RUN = 8  # row of the first body of its run: at most RUN_LENGTH bodies, each the only child of the one before
SLOT = 9  # which run that is
COLUMNS = 10

RUN_LENGTH = 8

FIXED, REVOLUTE, PRISMATIC = 0, 1, 2
