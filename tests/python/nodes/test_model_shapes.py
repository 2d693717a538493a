"""Models in URDF and SDF: their outline on the floor."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator import Shape
from mobile_robot_simulator.nodes.model_shapes import shape_of_model

BOX = '<robot name="a"><link name="b"><collision><geometry><box size="1.0 0.5 2"/></geometry></collision></link></robot>'


def sdf(geometry: str, more: str = "") -> str:
    part = f"<geometry>{geometry}</geometry>"
    return (
        f"<?xml version='1.0'?><sdf version='1.6'><model name='a'>{more}<link name='b'>"
        f"<visual name='v'><geometry><box><size>9 9 9</size></box></geometry></visual><collision name='c'>{part}</collision>"
        "</link></model></sdf>"
    )


@pytest.mark.parametrize(
    ("xml", "shape"),
    [
        (BOX, Shape.rectangle(1.0, 0.5)),
        (BOX.replace("collision", "visual"), Shape.rectangle(1.0, 0.5)),
        (BOX.replace('<box size="1.0 0.5 2"/>', '<cylinder radius="0.3" length="1"/>'), Shape.disc(0.3)),
        (BOX.replace("<collision>", '<collision><!-- lifted --><origin xyz="0 0 1.0"/>'), Shape.rectangle(1.0, 0.5)),
        (sdf("<box><size>1 0.5 2</size></box>"), Shape.rectangle(1.0, 0.5)),
        (sdf("<sphere><radius> 0.25 </radius></sphere>", "<pose>0 0 0.25 0 0 0</pose>"), Shape.disc(0.25)),
        (sdf("<cylinder><radius>0.3</radius><length>1</length></cylinder>"), Shape.disc(0.3)),
    ],
)
def test_one_upright_shape_gives_its_outline(xml: str, shape: Shape) -> None:
    assert shape_of_model(xml) == shape


@pytest.mark.parametrize(
    ("xml", "message"),
    [
        ("", "the model must be URDF or SDF"),
        ("box", "the model must be URDF or SDF"),
        ("<robot>", "the model must be URDF or SDF"),
        ("<robot/>", "the model must have one geometry, it has 0"),
        (f"<all>{BOX}{BOX}</all>", "the model must have one geometry, it has 2"),
        (sdf("<mesh><uri>a</uri></mesh>"), "the geometry must be a box, a cylinder or a sphere, got ['mesh']"),
        (BOX.replace("1.0 0.5 2", "1.0 0.5"), "the size of a box must have 3 numbers, got '1.0 0.5'"),
        (BOX.replace("1.0 0.5 2", "1.0 wide 2"), "size must be numbers, got '1.0 wide 2'"),
        (sdf("<sphere/>"), "the radius of a sphere must have 1 numbers, got ''"),
        (sdf("<sphere><radius>-1</radius></sphere>"), "radius"),
        (sdf("<sphere><radius>nan</radius></sphere>"), "radius"),
        (sdf("<sphere><radius>1</radius></sphere>", "<pose>1 0 0 0 0 0</pose>"), "must stand upright at the origin"),
        (BOX.replace("<collision>", '<collision><origin rpy="0 0 0.1"/>'), "must stand upright at the origin"),
        (f'<!DOCTYPE a [<!ENTITY b "c">]>{BOX}', "the model must have no document type"),
    ],
)
def test_what_is_no_such_model_is_an_error(xml: str, message: str) -> None:
    with pytest.raises(ValueError) as raised:
        shape_of_model(xml)
    assert message in str(raised.value)


def test_the_sizes_are_full_lengths() -> None:
    assert shape_of_model(BOX).points is not None and math.isclose(max(x for x, _ in shape_of_model(BOX).points), 0.5)
