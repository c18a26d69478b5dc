"""Study files: sweeps, clear errors with paths, the schema."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import jsonschema
import pytest

import pacinian as pc
import pacinian_lab.study as ps
from pacinian_lab.study.layouts import Autd, Lattice
from pacinian_lab.study.patterns import Focus, Points
from pacinian_lab.study.study_file import Method, Study, read, schema
from pacinian_lab.study.sweep import entries
from pacinian_lab.study.tasks import Plan

if TYPE_CHECKING:
    from collections.abc import Callable

STUDIES = sorted((Path(__file__).parents[3] / "examples" / "studies").glob("*.toml"))
PART = '[[layouts]]\ntype = "autd"\n[[patterns]]\ntype = "focus"\n'


def planned(path: Path) -> Plan:
    return Plan(read(path), str(path))


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_shipped_studies_keep_to_the_schema_and_are_not_large(path: Path) -> None:
    jsonschema.validate(tomllib.loads(path.read_text()), schema())
    plan = planned(path)
    assert 10 < len(plan.tasks) < 500
    assert plan.study.title


def test_the_schema_refuses_what_the_reader_refuses() -> None:
    for text in (PART + "gian = 1.0", '[[layouts]]\ntype = "latice"\n[[patterns]]\ntype = "focus"'):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(tomllib.loads(text), schema())


def test_lists_are_swept_all_with_each_other() -> None:
    found = entries(Lattice(width=(0.1, 0.2), pitch=(0.01, 0.02), hinge="y"))
    assert [(e.value.width, e.value.pitch) for e in found] == [
        (w, p) for p in (0.01, 0.02) for w in (0.1, 0.2)
    ]
    assert found[0].label == "lattice pitch=0.01, width=0.1"
    assert [e.label for e in entries(Lattice(name="mine", width=0.1))] == ["mine"]
    assert len(entries(Points(points=((0.0, 0.0), (0.01, 0.0))), Points.whole)) == 1


def test_options_of_a_solver_are_swept_too() -> None:
    method = Method(name="gs-pat", options={"steps": (10, 100)}, phases=0.0)
    assert [e.label for e in method.entries()] == [f"gs-pat steps={n}, phases=0" for n in (10, 100)]
    assert [e.value.options for e in method.entries()] == [{"steps": n} for n in (10, 100)]


def test_a_study_is_the_product_of_its_parts(write: Callable[..., Path]) -> None:
    plan = planned(write())
    assert len(plan.tasks) == 3 * 1 * 2 * 2 * 2
    assert len({task.key for task in plan.tasks}) == len(plan.tasks)
    assert plan.tasks[1].level == math.inf


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "patterns|layouts"),
        ('layouts = []\n[[patterns]]\ntype = "focus"', "`layouts` must not be empty"),
        (PART + "[[planes]]\nz = []", r"\$.planes\[0\]: `z` is swept over nothing"),
        (PART + "[[planes]]\nz = nan", r"\$.planes\[0\]: `z` must be finite"),
        (PART + "[[planes]]\nz = [0.1, nan]", r"`z\[1\]` must be finite"),
        ("levels = []\n" + PART, "`levels` must not be empty"),
        ("levels = [0.0]\n" + PART, r"`levels\[0\]` must be more than 0"),
        ("levels = [nan]\n" + PART, r"`levels\[0\]` must be finite"),
        ("solvers = []\n" + PART, "`solvers` must not be empty"),
        ('solvers = ["magic"]\n' + PART, r"\$.solvers\[0\]: no solver is called 'magic'"),
        (PART + '[[solvers]]\nname = "gs-pat"\noptions = { step = 3 }', "no option of solver 'gs-pat'"),
        (PART + '[[solvers]]\nname = "gs-pat"\noptions = { steps = [] }', "swept over nothing"),
        (PART + '[[solvers]]\nname = "pseudo-inverse"\noptions = { rcond = [0.1, nan] }',
         r"solvers\[0\]: pseudo-inverse rcond=nan: `rcond` must be finite"),
        (PART + '[[layouts]]\ntype = "latice"', r"\$.layouts\[1\].type: .*did you mean `lattice`"),
        (PART + '[[layouts]]\ntype = "lattice"\nwidht = 1.0', "did you mean `width`"),
        (PART + '[[layouts]]\ntype = "lattice"\nwidth = "wide"', "Expected `float | array`, got `str`"),
        (PART + '[[layouts]]\ntype = "lattice"\nwidth = [0.4, 0.1]\nbowl = 0.1',
         r"\$.layouts\[1\]: lattice bowl=0.1, width=0.4|lattice width=0.4: `bowl` of radius"),
        (PART + '[[layouts]]\ntype = "autd"', r"\$.layouts\[1\]: is called 'autd', as another one"),
        (PART + '[[layouts]]\ntype = "autd"\nname = "again"', "the same task twice"),
        (PART + '[[layouts]]\ntype = "device"\nfile = "no.toml"', "no.toml: cannot be read"),
        (PART + '[[patterns]]\ntype = "circle"\nradius = 0.4\ncount = 3', r"picture.side.*too small"),
        ("gain = inf\nlevels = [inf]\n" + PART, "`gain` must be finite"),
        ("gain = 2.0\nemitted = { phases = 8 }\n" + PART, "`gain` must be at most 1"),
        ("picture = { side = 0.2, step = 1e-5 }\n" + PART, "pixels"),
        ("seed = -1\n" + PART, "seed"),
        ("levels = [0.1", "is not TOML"),
    ],
)  # fmt: skip
def test_what_cannot_be_meant_is_refused_with_its_place(
    text: str, says: str, write: Callable[..., Path]
) -> None:
    with pytest.raises(pc.SceneFileError, match=says):
        planned(write(text))


def test_too_many_tasks_are_refused_before_they_are_made(write: Callable[..., Path]) -> None:
    many = ", ".join(str(0.001 * n) for n in range(1, 400))
    text = PART + f"[[planes]]\nx = [{many}]\ny = [{many}]"
    with pytest.raises(pc.SceneFileError, match="159201 combinations"):
        planned(write(text))
    text = f"levels = [{many}]\n" + PART
    with pytest.raises(pc.SceneFileError, match="119301 tasks: more than"):
        planned(write(text + f"[[planes]]\nx = [{', '.join(many.split(', ')[:299])}]"))


def test_a_devices_description_is_read_with_the_study(write: Callable[..., Path]) -> None:
    write("[[boards]]\ngain = 0.5\n", "board.toml")
    path = write('[[layouts]]\ntype = "device"\nfile = "board.toml"\n[[patterns]]\ntype = "focus"')
    plan = planned(path)
    array = plan.array(plan.tasks[0].place.layout.value)
    assert len(array) == 249
    before = plan.digest
    write("[[boards]]\ngain = 0.6\n", "board.toml")
    assert planned(path).digest != before


def test_a_study_of_python_is_one_of_a_file(write: Callable[..., Path]) -> None:
    ours = ps.Study(
        layouts=(ps.Lattice(width=1, pitch=(0.1, 0.2)),),
        patterns=(ps.Circle(radius=0.03, count=4), ps.Focus()),
        levels=(1,),
    )
    path = write("""
    levels = [1]
    layouts = [{ type = "lattice", width = 1, pitch = [0.1, 0.2] }]
    patterns = [{ type = "circle", radius = 0.03, count = 4 }, { type = "focus" }]
    """)
    assert Plan(ours).digest == planned(path).digest
    with pytest.raises(pc.SceneFileError, match="Expected `str`"):
        Plan(Study(layouts=(Autd(),), patterns=(Focus(),), title=3))  # type: ignore[arg-type]


def test_keys_follow_from_what_numbers_depend_on_and_from_nothing_else(
    write: Callable[..., Path],
) -> None:
    text = write().read_text()
    before = {t.key: t for t in planned(write()).tasks}

    def kept(changed: str) -> set[str]:
        return {t.key for t in planned(write(changed)).tasks} & before.keys()

    assert kept('title = "other"\n' + text) == before.keys()
    assert kept(text.replace('type = "focus"', 'type = "focus"\nname = "spot"')) == before.keys()
    assert kept(text.replace("[0.03, 0.05]", "[0.05, 0.03]")) == before.keys()
    assert not kept("gain = 0.9\n" + text)
    drawn = {
        key
        for key, t in before.items()
        if t.place.layout.value.drawn or t.place.pattern.value.drawn
    }
    assert kept("seed = 1\n" + text) == before.keys() - drawn
    assert len(kept(text.replace("[0.03, 0.05]", "[0.03, 0.04]"))) == len(before) - 8
    assert len(kept(text.replace('["auto", "gs-pat"]', '["auto"]'))) == len(before) / 2


def test_a_problem_that_no_memory_holds_is_refused_before_anything_is_made(
    write: Callable[..., Path],
) -> None:
    text = """
    layouts = [{ type = "lattice", width = 0.4, pitch = [0.02, 0.003] }]
    patterns = [{ type = "grid", columns = 100, rows = 100, pitch = 0.002 }]
    """
    with pytest.raises(pc.SceneFileError, match="10000 points of 17956 transducers"):
        planned(write(text))
