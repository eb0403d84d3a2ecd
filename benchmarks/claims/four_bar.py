"""The four-bar of the tutorial, in the formats and dialects of other programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

_LINKS = {"crank": (0.12, 0.12), "coupler": (0.37, 0.37), "rocker": (0.25, 0.25)}  # length m, mass kg

#: Mass of the moving links, kg.
MASS = sum(mass for _, mass in _LINKS.values())

URDF = (Path(__file__).parents[2] / "spec" / "examples" / "tutorial" / "robot.urdf").read_text(encoding="utf-8")


#: The loop of the four-bar as elements of a URDF, by the dialect of the page's table.
LOOPS = {
    "`<loop>`": """<loop name="rocker_pin" type="revolute">
  <predecessor link="coupler"><origin xyz="0.37 0 0"/></predecessor>
  <successor link="rocker"><origin xyz="0.25 0 0"/></successor>
  <axis xyz="0 0 1"/>
</loop>""",
    "`<constraint>`": """<constraint name="rocker_pin" type="spherical">
  <parent link="coupler"/><parent_origin xyz="0.37 0 0"/>
  <child link="rocker"/><child_origin xyz="0.25 0 0"/>
</constraint>""",
    "`drake:ball_constraint`": """<drake:ball_constraint>
  <drake:ball_constraint_body_A name="coupler"/><drake:ball_constraint_body_B name="rocker"/>
  <drake:ball_constraint_p_AP value="0.37 0 0"/><drake:ball_constraint_p_BQ value="0.25 0 0"/>
</drake:ball_constraint>""",
    "`drake:weld_constraint`": """<drake:weld_constraint>
  <drake:weld_constraint_body_A name="coupler"/><drake:weld_constraint_body_B name="rocker"/>
  <drake:weld_constraint_p_AP value="0.37 0 0"/><drake:weld_constraint_p_BQ value="0.25 0 0"/>
</drake:weld_constraint>""",
}

#: A joint of a type that URDF does not have, in place of the pivot of the rocker.
BALL_JOINT = URDF.replace('<joint name="rocker_pivot" type="continuous">', '<joint name="rocker_pivot" type="ball">')


def with_elements(elements: str) -> str:
    """The URDF of the four-bar with further elements."""
    return URDF.replace(
        '<robot name="four_bar">', '<robot name="four_bar" xmlns:drake="http://drake.mit.edu">'
    ).replace("</robot>", f"{elements}\n</robot>")


def with_two_parents() -> Iterator[str]:
    """The URDF with the pin as a further joint: both orders of its links, three names, two places in the file."""
    for parent, child in (("coupler", "rocker"), ("rocker", "coupler")):
        at = {"coupler": 0.37, "rocker": 0.25}[parent]
        for name in ("a_pin", "rocker_pin", "z_pin"):
            joint = f"""<joint name="{name}" type="continuous">
  <origin xyz="{at} 0 0"/><parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/>
</joint>"""
            yield URDF.replace("</robot>", f"{joint}\n</robot>")
            yield URDF.replace('<joint name="motor_crank"', f'{joint}\n<joint name="motor_crank"', 1)


def mjcf(equalities: Sequence[str] = ("connect",), tail: str = "") -> str:
    """The four-bar in MJCF.

    Args:
        equalities: Which equalities it has: ``connect`` and ``weld`` between sites, ``connect of bodies``, ``joint``.
        tail: Further elements.
    """
    known = {
        "connect": '<connect name="rocker_pin" site1="pin_on_coupler" site2="pin_on_rocker"/>',
        "weld": '<weld name="rocker_pin" site1="pin_on_coupler" site2="pin_on_rocker"/>',
        "connect of bodies": '<connect name="rocker_pin" body1="coupler" body2="rocker" anchor="0.37 0 0"/>',
        "joint": '<joint name="geared" joint1="crank_pin" joint2="rocker_pivot" polycoef="0 1 0 0 0"/>',
    }
    return f"""<mujoco model="four_bar">
  <compiler angle="radian"/>
  <worldbody><body name="ground">
    <body name="crank" euler="0 0 1.0472">
      <joint name="motor_crank" axis="0 0 1"/>
      {_inertial("crank")}
      <body name="coupler" pos="0.12 0 0" euler="0 0 -0.643638519">
        <joint name="crank_pin" axis="0 0 1"/>
        {_inertial("coupler")}
        <site name="pin_on_coupler" pos="0.37 0 0"/>
      </body>
    </body>
    <body name="rocker" pos="0.42 0 0" euler="0 0 1.649770402">
      <joint name="rocker_pivot" axis="0 0 1"/>
      {_inertial("rocker")}
      <site name="pin_on_rocker" pos="0.25 0 0"/>
    </body>
  </body></worldbody>
  <equality>{"".join(known[name] for name in equalities)}</equality>
  {tail}
</mujoco>"""


def _inertial(link: str) -> str:
    length, mass = _LINKS[link]
    across = mass * length**2 / 12
    return f'<inertial pos="{length / 2} 0 0" mass="{mass}" diaginertia="1e-5 {across} {across}"/>'


def sdf(closing: str = "", effort: float = 0.0) -> str:
    """The four-bar in SDFormat.

    Args:
        closing: The element that closes the loop.
        effort: Effort limit of the motor, N·m; the other joints have 0.
    """
    poses = {
        "crank": "0 0 0 0 0 1.0472",
        "coupler": "0.06 0.103923 0 0 0 0.4036",
        "rocker": "0.42 0 0 0 0 1.6498",
    }
    links = "".join(
        f"""<link name="{link}"><pose>{poses[link]}</pose>
<inertial><mass>{mass}</mass><pose>{length / 2} 0 0 0 0 0</pose>
<inertia><ixx>1e-5</ixx><iyy>1e-3</iyy><izz>1e-3</izz></inertia></inertial></link>"""
        for link, (length, mass) in _LINKS.items()
    )
    pairs = (("motor_crank", "world", "crank"), ("crank_pin", "crank", "coupler"), ("rocker_pivot", "world", "rocker"))
    joints = "".join(
        f"""<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child>
<axis><xyz>0 0 1</xyz><limit><effort>{effort if name == "motor_crank" else 0}</effort></limit></axis></joint>"""
        for name, parent, child in pairs
    )
    return f"""<sdf version="1.12" xmlns:drake="http://drake.mit.edu"><model name="four_bar">{links}{joints}{closing}
</model></sdf>"""


#: The pin as a joint of SDFormat whose child has another parent.
SDF_PIN = """<joint name="rocker_pin" type="ball"><pose>0.25 0 0 0 0 0</pose>
<parent>coupler</parent><child>rocker</child></joint>"""
