"""Conversion of wire objects to objects of `pacinian.scene` and back, exact to the precision of float32."""

from __future__ import annotations

from typing import Any

from msgspec.msgpack import Decoder

from pacinian.argument_checks import check_kind
from pacinian.scene import objects as scene
from pacinian.scene.material import DEFAULT_MATERIAL, Material
from pacinian.scene.modulation.technique import SIMULTANEOUS
from pacinian.scene.motion import Motion
from pacinian.wire import objects
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.codec import check_part
from pacinian.wire.convert_modulation import (
    envelope_to_scene,
    envelope_to_wire,
    technique_to_scene,
    technique_to_wire,
)
from pacinian.wire.convert_shapes import (
    pose_to_scene,
    pose_to_wire,
    shape_to_scene,
    shape_to_wire,
    texture_to_scene,
    texture_to_wire,
)
from pacinian.wire.decode_errors import CONVERSION_ERRORS, locate, locate_errors

__all__ = [
    "envelope_to_scene",
    "envelope_to_wire",
    "technique_to_scene",
    "technique_to_wire",
    "to_scene",
    "to_wire",
]

DEFAULT_WIRE_MATERIAL = objects.Material()
_objects: Decoder[objects.Object] = Decoder(objects.Object)


def to_scene(name: str, item: objects.Object, time: float = 0.0) -> scene.Object:
    """Convert a wire object to a scene object. Raises WireError.

    name: name of the object. time: time from which its motion counts [s].
    """
    try:
        return _to_scene(name, item, time)
    except CONVERSION_ERRORS as error:
        raise locate(f"$.objects[{name}]", item, error) from error


def to_wire(item: scene.Object, duration: float | None = None) -> objects.Object:
    """Convert a scene object, without its name, to a wire object. Reads its files.

    duration: time after which the server removes it [s]. The default technique becomes the choice of the server. Raises
    WireError if the object cannot be sent or exceeds the bounds of the wire, and ArgumentError if it is no object.
    """
    check_kind("item", item, scene.Point, scene.Path, scene.Particles, scene.Surface, scene.Volume)
    return check_part(_objects, locate_errors("$", lambda i: _to_wire(i, duration), item))


def _to_scene(name: str, item: objects.Object, time: float) -> scene.Object:
    technique, material, motion = item.technique, item.material, item.motion
    felt: dict[str, Any] = {
        "radiation_pressure": item.radiation_pressure,
        "force": item.force,
        "envelope": envelope_to_scene(item.envelope, ".envelope"),
        "technique": technique_to_scene(technique, ".technique") if technique else SIMULTANEOUS,
        "material": DEFAULT_MATERIAL
        if material == DEFAULT_WIRE_MATERIAL
        else Material(stiffness=material.stiffness, reach=material.reach),
        "motion": motion and Motion(motion.velocity, motion.angular_velocity, time),
        "priority": item.priority,
        "name": name,
    }
    if isinstance(item, objects.Point):
        return scene.Point(position=item.position, area=item.area, **felt)
    felt["pose"] = locate_errors(".pose", pose_to_scene, item.pose)
    if isinstance(item, objects.Particles):
        positions: Any = unpack(item.positions, 3)
        return scene.Particles(positions=positions, radius=item.radius, **felt)
    shape = locate_errors(".shape", shape_to_scene, item.shape)
    if isinstance(item, objects.Path):
        return scene.Path(shape=shape, width=item.width, **felt)
    felt["thickness"] = item.thickness
    if item.texture is not None:
        felt["texture"] = locate_errors(".texture", texture_to_scene, item.texture)
    if isinstance(item, objects.Volume):
        return scene.Volume(shape=shape, felt=item.felt, **felt)
    return scene.Surface(shape=shape, **felt)


def _to_wire(item: scene.Object, duration: float | None) -> objects.Object:
    technique, material, motion = item.technique, item.material, item.motion
    same = technique is SIMULTANEOUS
    felt: dict[str, Any] = {
        "radiation_pressure": item.radiation_pressure,
        "force": item.force,
        "envelope": envelope_to_wire(item.envelope, ".envelope"),
        "technique": None if same else technique_to_wire(technique, ".technique"),
        "material": objects.Material(material.stiffness, material.reach),
        "motion": motion and objects.Motion(motion.velocity, motion.angular_velocity),
        "priority": item.priority,
        "duration": duration,
    }
    if isinstance(item, scene.Point):
        return objects.Point(position=item.position, area=item.area, **felt)
    felt["pose"] = pose_to_wire(item.pose)
    if isinstance(item, scene.Particles):
        return objects.Particles(positions=pack(item.positions), radius=item.radius, **felt)
    shape = locate_errors(".shape", shape_to_wire, item.shape)
    if isinstance(item, scene.Path):
        return objects.Path(shape=shape, width=item.width, **felt)
    felt["thickness"] = item.thickness
    if item.texture is not None:
        felt["texture"] = locate_errors(".texture", texture_to_wire, item.texture)
    if isinstance(item, scene.Volume):
        return objects.Volume(shape=shape, felt=item.felt, **felt)
    return objects.Surface(shape=shape, **felt)
