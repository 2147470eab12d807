"""The well of the tests of weight, torque and slow rows: 2400 m of drill pipe and collars, friction 0.25."""

LENGTH = 2400.0
"""Of the string, m."""
DEVIATED = "[{hold: 600 m}, {build: {rate: 3 deg/30m, to: 60 deg}}, {hold: 1200 m}]"
VERTICAL = "[{hold: 2400 m}]"
WELL = """
well:
  sections: SECTIONS
  diameter: 8.5 in
  wall: {stiffness: 1.0e9, damping: 2.0e6, friction: 0.25}
string:
  - {name: drill pipe, length: rest, od: 0.127, id: 0.1086}
  - {name: collars, length: 80 m, od: 0.165, id: 0.0714}
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 1200}
damping: {rotation: 5, translation: TRANSLATION, structural: STRUCTURAL}
top: {block: 0, rotation: 0}
bit: {on_bottom: false}
model: {kind: lumped, elements: 40}
solver: {method: generalized-alpha, rho_inf: 0.5, step: 10 ms, end: END}
output: {interval: INTERVAL}
"""


def well(sections: str, end: str, interval: str, translation: str = "50", structural: str = "5 ms") -> str:
    """The scene with other sections, times and damping."""
    given = {"SECTIONS": sections, "TRANSLATION": translation, "STRUCTURAL": structural, "END": end}
    text = WELL
    for word, value in (given | {"INTERVAL": interval}).items():
        text = text.replace(word, value)
    return text
