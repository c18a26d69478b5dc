"""All results of the paper that can be computed, as one object, for tables, JSON and figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from pacinian_lab.paper import experiment, focus, fourier
from pacinian_lab.paper.force import forces
from pacinian_lab.solvers.report import replace_non_finite

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_lab.paper.experiment import Experiment
    from pacinian_lab.paper.focus import Focus, Width
    from pacinian_lab.paper.force import Force
    from pacinian_lab.paper.fourier import Comparison

STEPS = 2 + sum(
    (
        len(experiment.CASES) * (1 + len(experiment.PATTERNS)),
        len(fourier.PLACES) * len(experiment.PATTERNS),
    )
)

EXPERIMENT_NOTES = (
    'The paper\'s text gives the array as "20mm in x axis and 40mm in y axis": room for only 15 transducers,'
    " which cannot form a pattern. Here it is 200 mm x 400 mm, folded about the x axis with each half raised by 45"
    " degrees. This array reproduces the paper's findings.",
    "1a and 1b differ less than 2a and 2b do; 2a is worse than 2b in correlation and in maximum.",
    "Equation (9) as printed cannot be evaluated in 2a and 2b: the array is mirror-symmetric about the"
    " region's plane, so columns of B are equal in pairs and B^H B has no inverse. The condition"
    " number is infinite; rounding makes it 1e15 or more. The solver drops singular values below 1e-10 of the"
    " largest.",
    "The paper's patterns cannot be read off its figures to the sample; the shapes here are Pacinian's.",
)
FOURIER_NOTES = (
    "In 1a, at 200 mm, the Fourier method fails even in the parallel plane, because the angles are not small, and with"
    " 10 mm between transducers the image repeats every 170 mm within the 400 mm region. At 600 mm it"
    " repeats every 510 mm, and the method does as well as the pseudo-inverse (there with singular values"
    " below 1e-3 of the largest dropped, because they only make the gains huge).",
    "In 2a it has no meaning, because it puts samples of all heights into one plane.",
)
FOCUS_NOTES = (
    "1.22 lambda z / aperture holds for a circular aperture. For a rectangle's side the factor is 1;"
    " directivity and distance, which weaken the rim, raise it to about 1.1.",
    "The linear model gives more force than was measured, above all with 9 units. A plane wave of its amplitude"
    " at the focus would form a shock within the distance in the last column (the wavelength is 8.5 mm):"
    " the air turns the excess into harmonics and heat, so superposition over-predicts. Without these losses,"
    " 9 units would have about 9 times the power and force of one. The paper measured 4.6 times.",
    "P0 = 4.386 Pa m (AUTD3 software, taken as peak) is uncertain: published values from 3.4 to 8.02"
    " Pa m scale every force by 0.6 to 3.3.",
    "The paper does not say how far the focus of its single unit was, nor over which area the force was"
    " measured; 200 mm and the main lobe are assumed. Absorption (1.3 dB/m) and the slant of sound from"
    " the array's rim are not modelled; both would lower the force.",
)


@dataclass(frozen=True)
class Report:
    """Section 5, the baseline of section 3, Figure 3 and the measured forces."""

    experiment: Experiment
    fourier: dict[tuple[str, str], Comparison]
    focus: Focus
    widths: list[Width]
    forces: list[Force]


def make(advance: Callable[[], object] = lambda: None) -> Report:
    """Compute everything. advance: called after each of `STEPS` steps."""
    results = experiment.run(advance)
    baseline = fourier.run(results.outcomes, advance)
    spot = focus.focus(3, 0.6)
    widths = focus.widths(spot)
    advance()
    found = forces()
    advance()
    return Report(results, baseline, spot, widths, found)


def plain(report: Report) -> dict[str, Any]:
    """Return the report's numbers in SI units, for JSON, with null for an infinite condition number."""
    spectra = report.experiment.spectra.values()
    return {
        "experiment": {
            "cases": [replace_non_finite(asdict(spectrum)) for spectrum in spectra],
            "outcomes": [
                {
                    "pattern": o.pattern,
                    "case": o.case,
                    "correlation": o.correlation,
                    "error": o.error,
                    "maximum": o.maximum,
                }
                for o in report.experiment.outcomes.values()
            ],
            "notes": EXPERIMENT_NOTES,
        },
        "fourier": {
            "outcomes": [
                {
                    "pattern": c.pattern,
                    "place": c.place,
                    "correlation": c.correlation,
                    "maximum": c.maximum,
                    "pseudo_inverse_correlation": c.pseudo_inverse.correlation,
                    "pseudo_inverse_maximum": c.pseudo_inverse.maximum,
                }
                for c in report.fourier.values()
            ],
            "notes": FOURIER_NOTES,
        },
        "focus": {
            "widths": [asdict(width) for width in report.widths],
            "forces": [asdict(force) for force in report.forces],
            "notes": FOCUS_NOTES,
        },
    }
