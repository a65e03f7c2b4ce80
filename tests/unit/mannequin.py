"""BVH text of a made-up player of 22 joints who swings a club; centimetres, y up, facing +z, left is +x."""

import math

# name, parent, offset
JOINTS = [
    ("Hips", None, (0.0, 0.0, 0.0)),
    ("LeftUpLeg", "Hips", (10.0, -5.0, 0.0)),
    ("LeftLeg", "LeftUpLeg", (0.0, -42.0, 0.0)),
    ("LeftFoot", "LeftLeg", (0.0, -43.0, 0.0)),
    ("LeftToeBase", "LeftFoot", (0.0, -6.0, 13.0)),
    ("RightUpLeg", "Hips", (-10.0, -5.0, 0.0)),
    ("RightLeg", "RightUpLeg", (0.0, -42.0, 0.0)),
    ("RightFoot", "RightLeg", (0.0, -43.0, 0.0)),
    ("RightToeBase", "RightFoot", (0.0, -6.0, 13.0)),
    ("Spine", "Hips", (0.0, 10.0, 0.0)),
    ("Spine1", "Spine", (0.0, 20.0, 0.0)),
    ("Neck", "Spine1", (0.0, 20.0, 0.0)),
    ("Head", "Neck", (0.0, 10.0, 2.0)),
    ("LeftShoulder", "Spine1", (5.0, 15.0, 0.0)),
    ("LeftArm", "LeftShoulder", (12.0, 0.0, 0.0)),
    ("LeftForeArm", "LeftArm", (0.0, -29.0, 0.0)),
    ("LeftHand", "LeftForeArm", (0.0, -25.0, 0.0)),
    ("RightShoulder", "Spine1", (-5.0, 15.0, 0.0)),
    ("RightArm", "RightShoulder", (-12.0, 0.0, 0.0)),
    ("RightForeArm", "RightArm", (0.0, -29.0, 0.0)),
    ("RightHand", "RightForeArm", (0.0, -25.0, 0.0)),
    ("Club", "RightHand", (0.0, -8.0, 0.0)),
]
ENDS = {
    "LeftToeBase": (0.0, 0.0, 6.0),
    "RightToeBase": (0.0, 0.0, 6.0),
    "Head": (0.0, 18.0, 0.0),
    "LeftHand": (0.0, -15.0, 0.0),
    "Club": (0.0, -70.0, 55.0),
}
HIPS_HEIGHT = 98.0


def bvh_text(*, frames=12, z_up=False, scale=1.0, hips_height=HIPS_HEIGHT, step=0.0, swing=60.0, frame_time=0.04):
    """Return the file; `step` is the way forward per frame, `swing` the arms' largest turn in degrees."""

    def place(v):
        x, y, z = (scale * part for part in v)
        return "{:.6f} {:.6f} {:.6f}".format(*((x, -z, y) if z_up else (x, y, z)))

    lines = ["HIERARCHY"]

    def write(name, depth):
        pad = "\t" * depth
        _, parent, offset = next(row for row in JOINTS if row[0] == name)
        lines.extend((f"{pad}{'JOINT' if parent else 'ROOT'} {name}", pad + "{", f"{pad}\tOFFSET {place(offset)}"))
        positions = "" if parent else "Xposition Yposition Zposition "
        lines.append(f"{pad}\tCHANNELS {3 if parent else 6} {positions}Zrotation Xrotation Yrotation")
        for child in (row[0] for row in JOINTS if row[1] == name):
            write(child, depth + 1)
        if name in ENDS:
            lines.extend((f"{pad}\tEnd Site", f"{pad}\t{{", f"{pad}\t\tOFFSET {place(ENDS[name])}", f"{pad}\t}}"))
        lines.append(pad + "}")

    write("Hips", 0)
    lines += ["MOTION", f"Frames: {frames}", f"Frame Time: {frame_time}"]
    for f in range(frames):
        angle = swing * math.sin(math.pi * f / max(1, frames - 1))
        row = [place((0.0, hips_height, step * f))]
        # The x axis points to the left whichever axis is up: one angle serves both.
        row += [f"0 {-angle:.6f} 0" if name in ("RightArm", "LeftArm") else "0 0 0" for name, _, _ in JOINTS]
        lines.append(" ".join(row))
    return "\n".join(lines) + "\n"
