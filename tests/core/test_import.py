from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
import pytest

import pacinian
from pacinian import array_api, plot
from pacinian.plugins.registry import discover_plugins

SOLVERS = [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
STUB = Path(pacinian.__file__).with_suffix(".pyi")


def promised() -> list[str]:
    """Return the names in the table of contents."""
    return [
        alias.asname or alias.name
        for node in ast.parse(STUB.read_text("utf-8")).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]


def fresh(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=100
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_the_air_has_a_default_only_where_the_result_keeps_it() -> None:
    """Elsewhere, a forgotten medium would go unnoticed. `plot.export` needs one only for fields, then rejects None."""
    defaults: set[str] = set()
    for place in (pacinian, plot, array_api):
        for name in dir(place):
            made = getattr(place, name)
            if inspect.isfunction(made) or (inspect.isclass(made) and "__init__" in vars(made)):
                air = inspect.signature(made).parameters.get("medium")
                if air is not None and air.default is not air.empty:
                    defaults.add(name)
    keep = {"solve", "solve_many", "Session", "Renderer"}
    assert defaults == keep | {"export"}


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Imports in functions and those for type checkers count, too."""
    packages = "pacinian", "pacinian_plugins", "pacinian_lab"
    graph = grimp.build_graph(*packages, exclude_type_checking_imports=False, cache_dir=None)
    imports = {name: graph.find_modules_directly_imported_by(name) for name in graph.modules}
    TopologicalSorter(imports).prepare()  # raises CycleError, which names the circle


def test_importing_pacinian_loads_no_heavy_library_and_none_of_its_own_modules() -> None:
    heavy = {"numpy", "scipy", "matplotlib", "trimesh", "msgspec", "zmq", "rich", "click"}
    code = f"import sys, pacinian; print(sorted({heavy!r} & set(sys.modules)))\n"
    code += "print([m for m in sys.modules if m.startswith('pacinian.')])"
    assert fresh(code) == "[]\n[]"


def test_every_name_is_there_in_a_fresh_interpreter_in_any_order() -> None:
    names = promised()
    code = f"import pacinian\nfor name in {names[::-1]!r}: assert getattr(pacinian, name) is not None, name\n"
    for name in names:  # none is a submodule that became an attribute by an import
        code += f"assert type(pacinian.{name}).__name__ != 'module', {name!r}\n"
    fresh(code)


def test_all_is_the_table_of_contents() -> None:
    assert len(set(promised())) == len(promised())
    assert sorted(pacinian.__all__) == sorted(promised())
    assert set(promised()) <= set(dir(pacinian))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="nonsense"):
        pacinian.nonsense  # noqa: B018


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pose", "did you mean 'Pose'"),
        ("Autd", "did you mean 'autd'"),
        ("radiation_presure", "'radiation_pressure'"),
        ("load_scenefile", "'load_scene_file'"),
        ("plot", "from pacinian import plot"),
        ("qqqq", "no attribute 'qqqq'"),
    ],
)
def test_a_misspelt_name_is_answered_with_the_one_that_is_meant(name: str, said: str) -> None:
    code = (
        "import pacinian as pc\ntry: pc." + name + "\nexcept AttributeError as error: print(error)"
    )
    text = fresh(code)
    assert said in text
    assert ("did you mean" in text) is (name not in ("plot", "qqqq"))


def test_hasattr_and_getattr_work_for_missing_names() -> None:
    assert not hasattr(pacinian, "no_such_name")
    assert getattr(pacinian, "no_such_name", 1) == 1


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("points", ["[(0.0, 0.0, 0.2)]", "[(0.0, 0.0, 0.2), (0.03, 0.0, 0.2)]"])
def test_the_time_of_the_first_solve_includes_no_loading(points: str, solver: str) -> None:
    code = (
        "import sys, pacinian as pc\n"
        f"session = pc.Session(pc.autd(), solver={solver!r})\n"
        "before = set(sys.modules)\n"
        f"session.solve({points}, 1000.0)\n"
        "print(*sorted(set(sys.modules) - before))"
    )
    assert fresh(code) == ""
