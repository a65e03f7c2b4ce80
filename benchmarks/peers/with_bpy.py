"""The reach in Blender without its window: import a clip, IK constraints on wrist and ankles, bake, export.

Arguments: the clip, where to write, and a JSON file with the constraints: bones whose tails shall reach, lengths of
chains, and paths (frames, 3) in the clip's units, or null for the path that the tail has. With no constraints nothing
is baked. Prints the seconds of the bake.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import bpy


def main(source: str, output: str, constraints: list[dict[str, Any]]) -> None:
    """Edit the clip."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # These axes leave the clip's coordinates as they are.
    bpy.ops.import_anim.bvh(filepath=source, axis_forward="Y", axis_up="Z", update_scene_fps=True)
    armature = bpy.context.object
    scene = bpy.context.scene
    scene.frame_end = int(armature.animation_data.action.frame_range[1])
    start = time.perf_counter()
    if constraints:
        paths = [_path(armature, c) for c in constraints]
        for constraint, path in zip(constraints, paths, strict=True):
            ik = armature.pose.bones[constraint["bone"]].constraints.new("IK")
            ik.target, ik.chain_count = _empty(constraint["bone"], path), constraint["chain"]
        _bake(armature)
    seconds = time.perf_counter() - start
    last = scene.frame_end
    bpy.ops.export_anim.bvh(filepath=output, frame_start=1, frame_end=last, root_transform_only=True)
    print()
    print(json.dumps({"versions": {"bpy": bpy.app.version_string}, "seconds": seconds, "frames": last}))


def _path(armature: Any, constraint: dict[str, Any]) -> list[list[float]]:  # noqa: ANN401
    """Return the targets of a constraint by frame."""
    if constraint["path"] is not None:
        return constraint["path"]
    bone, scene, path = armature.pose.bones[constraint["bone"]], bpy.context.scene, []
    for frame in range(1, scene.frame_end + 1):
        scene.frame_set(frame)
        path.append(list(armature.matrix_world @ bone.tail))
    return path


def _empty(name: str, path: list[list[float]]) -> Any:  # noqa: ANN401
    """Return an object without a shape that goes along a path."""
    empty = bpy.data.objects.new(f"{name} target", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.animation_data_create().action = bpy.data.actions.new(f"{name} path")
    for axis in range(3):
        curve = empty.animation_data.action.fcurves.new("location", index=axis)
        curve.keyframe_points.add(len(path))
        values = [value for frame, place in enumerate(path, start=1) for value in (float(frame), place[axis])]
        curve.keyframe_points.foreach_set("co", values)
        curve.update()
    return empty


def _bake(armature: Any) -> None:  # noqa: ANN401
    bpy.ops.object.select_all(action="DESELECT")
    armature.select_set(True)  # noqa: FBT003
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="POSE")
    bpy.ops.nla.bake(
        frame_start=1,
        frame_end=bpy.context.scene.frame_end,
        only_selected=False,
        visual_keying=True,
        clear_constraints=True,
        use_current_action=True,
        bake_types={"POSE"},
    )


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], json.loads(Path(sys.argv[3]).read_text()))
