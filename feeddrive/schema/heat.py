"""Keys of [thermal] and of what stands inside it; `feeddrive.plant.file.heat_section` reads them."""

from __future__ import annotations

import math

from feeddrive.schema.key import SOURCE
from feeddrive.schema.section import sections

_ALONE = "where the motion declares no friction of its own"
_RIGHT = math.pi / 2
_FRICTION = f"""
load_torque | N m | >= 0 | required | friction torque from load and preload | {_ALONE}
viscous_factor | 1 | >= 0 | required | f0, times number of nuts and turns for a nut | {_ALONE}
viscosity | m^2/s | > 0 | required | kinematic viscosity of the lubricant | {_ALONE}
mean_diameter | m | > 0 | required | mean diameter of the rolling bodies' path | {_ALONE}
heat_share | 1 | [0, 1] | = 1 | share of the friction that becomes heat here
"""
_SEAT = """
seat_length | m | >= 0 | | length of the shaft in the bearing
film | W/(m^2 K) | >= 0 | | heat transfer from the seat to the air
end_share | 1 | [0, 1] | = 0 | share of the shaft's end face that convects
"""
_OIL = """
viscosity_40 | m^2/s | > 0 | required | kinematic viscosity at 40 degC
viscosity_100 | m^2/s | > 0 | required | kinematic viscosity at 100 degC
"""

THERMAL = sections(f"""
[plant.thermal] heat of screw, nut and bearings; fixed-fixed supports hold the screw at both ends, else the near one
shaft_radius | m | > 0 | required | half the diameter of the pitch circle, or the nominal radius
shaft_length | m | > 0 | required | length of the shaft
nut_outer_radius | m | > 0 | required | outer radius of the nut
nut_length | m | > 0 | required | length of the nut
travel | m list | | required | least and greatest place of the nut's centre, from the motor-side end
growth_positions | m list | | required | where the growth of the table position is wanted
conductivity | W/(m K) | > 0 | = 50 W/(m K) | of the steel
heat_capacity | J/(m^3 K) | > 0 | = 3.926e6 J/(m^3 K) | of the steel's volume
expansion | 1/K | | = 11.7e-6 1/K | of the steel's length
contact_conductance | W/(m^2 K) | > 0 | required | shaft to nut, at the preload
preload | N | > 0 | required | of the nut, for which friction and contact are declared
lead | m | > 0 | | table travel per turn; that of [ball_screw] if left out
ambient | degC | | required | temperature of the air, for which the machine is declared
highest_speed | rad/s | > 0 | = 1500 rev/min | up to which the reduced model has to hold
nut_heat_share | 1 | [0, 1] | = 1 | share of the heat on the nut's side of the contact
nut_end_share | 1 | [0, 1] | = 0 | share of the nut's end faces that convects
{SOURCE}

[plant.thermal.film] heat transfer to the air
screw | W/(m^2 K) | > 0 | required | of the screw at 250 rev/min, growing with speed to the power 2/3
screw_least | W/(m^2 K) | > 0 | required | of the screw at rest
nut_free | W/(m^2 K) | > 0 | required | of the nut at rest
nut_forced | W/(m^2 K) | > 0 | required | of the nut moving, at 250 rev/min
{SOURCE}

[plant.thermal.nut] friction heat of the nut
{_FRICTION}
{SOURCE}

[plant.thermal.front_bearing] friction heat and seat of the front bearing
{_FRICTION}
{_SEAT}
{SOURCE}

[plant.thermal.rear_bearing] friction heat and seat of the rear bearing
{_FRICTION}
{_SEAT}
{SOURCE}

[[plant.thermal.body]] one heat capacity beside screw and nut: motor, housing, table
name | text | | required | of the body, as sensors and other keys call it
port | text | front, rear, nut | required | where it touches
capacity | J/K | > 0 | required | heat capacity
conductance | W/K | > 0 | required | to the surface at the port
to_air | W/K | >= 0 | | conductance to the air
{SOURCE}

[plant.thermal.coupling] how heat and drive act on each other
nut_at_zero | m | | required | nut's centre from the fixed end where the table is at 0
nut_stiffness | N/m | > 0 | required | axial stiffness of the whole nut at its preload
group_distance | m | > 0 | required | distance of the two ball groups
contact_angle | rad | (0, {_RIGHT}) | required | contact angle of the balls in the nut
spacer | text | oversize, undersize | required | nuts pushed apart, or pulled together
rear_share | 1 | [0, 1] | = 0.5 | share of the bearings' friction in the rear one
motor_constant | N m/W^0.5 | > 0 | | torque per root of the winding's heat; without it the motor gives no heat
guide_heat_to | text | | = | name of a [[thermal.body]] that takes the heat of the guides; the bed if left out
{SOURCE}

[plant.thermal.coupling.nut_oil] lubricant of the nut
{_OIL}
{SOURCE}

[plant.thermal.coupling.bearing_oil] lubricant of the bearings; that of the nut if left out
{_OIL}
{SOURCE}
""")
"""[thermal] of a plant file."""
