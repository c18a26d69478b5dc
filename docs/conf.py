"""How the documentation is built: `sphinx-build -W docs build/docs`, after `pip install ".[docs]"`."""

import sys
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "building"))

project = "Pacinian"
author = copyright = "the Pacinian developers"  # noqa: A001
release = metadata.version("pacinian")
extensions = ["myst_parser", "sphinx.ext.autodoc", "docstrings", "equations", "sources"]
exclude_patterns = ["building"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
html_math_renderer = "mathml"

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
# the pages need no package that only a study needs
autodoc_mock_imports = [
    name for name in ("cryptography", "dask", "distributed", "pyarrow") if find_spec(name) is None
]
python_use_unqualified_type_names = True
add_module_names = False

html_theme = "furo"
html_title = f"Pacinian {release}"
html_copy_source = False
html_static_path = ["building/static"]
html_css_files = ["pages.css"]
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#31688e", "color-brand-content": "#31688e"},
    "dark_css_variables": {"color-brand-primary": "#5ec962", "color-brand-content": "#5ec962"},
}
