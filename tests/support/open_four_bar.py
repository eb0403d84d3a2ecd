"""URDFs of a four-bar with an open loop, to which a test adds what closes it."""

from support.plain_urdf import inertial, joint_element, link_element

LINKS = "".join(link_element(name, inertial(1.0)) for name in ("base", "left", "top", "right"))
TURN = '<axis xyz="0 1 0"/>'
JOINTS = (
    joint_element("a", "continuous", "base", "left", TURN)
    + joint_element("b", "continuous", "left", "top", TURN, '<origin xyz="0 0 1"/>')
    + joint_element("c", "continuous", "base", "right", TURN, '<origin xyz="1 0 0"/>')
)


def robot(content: str, attributes: str = "") -> str:
    """Its URDF with more elements, and with attributes of its root element."""
    return f'<robot name="r"{attributes}>{LINKS}{JOINTS}{content}</robot>'
