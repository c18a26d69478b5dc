"""Inputs and outputs of solvers: targets, limits, budget, propagator and solution. The solvers are plug-ins.

The API, `Session` and `solve`, is in `pacinian/session.py`.

What goes in
    targets.py            targets, their regions and their relative error
    limits.py             limits of gain, power, quiet points, exact samples and zones
    budget.py             budget of time
    problem_check.py      checks the points and targets that a user gives
    quiet_zone.py         what a quiet zone is, where it may be, and its places
    propagator.py         B = propagation from transducers to points, and what is derived from it, cached
    column_groups.py      transducers with equal columns of B share one gain
    factor.py             Cholesky factor of the regularised Gram matrix B B^H + mu I. mu: options of the solvers;
                          constants of skin_phases.py, region_phases.py, limit_enforcement.py
What solvers share
    warm_start.py         the last solution, carried over to points that moved, came or went
    phases.py             free phases of isolated points
    region_phases.py      phases of a region: those of one wave
    skin_phases.py        relaxes the phases of a region on skin, by Newton steps
    back_propagation.py   gains for many points if the deadline leaves no time for the Gram matrix
    target_scaling.py     targets in units of gain that suit iterative solvers
    corrections.py        larger amplitudes where regularisation leaves pressure missing
    least_squares.py      gains of least norm for any shape and rank of B
    quiet_subspace.py     gains that leave quiet zones quiet: prepared once for each set of zones
    quiet_basis.py        the basis that these gains must not contain
    loudest_places.py     search for the loudest places of a zone. How many are evaluated: to prepare the zone,
                          PLACES_PER_BATCH in quiet_zone.py; for a solution, WATCHED_PLACES in quiet_subspace.py; by
                          `certify`, MIN_PLACES and MAX_PLACES in loudest_places.py
    limit_enforcement.py  limits of gain, power, quiet points and zones, whatever a solver writes; NaN to silence
    linalg.py             BLAS and LAPACK without the rest of SciPy
    blas.py               one BLAS thread for small problems
    buffer_pool.py        workspaces that repeated solves share
What comes out
    solution.py           `Solution`: field, pressure, force, plot, save
    solution_metrics.py   its figures: error, shape error, gap, count at the limit
    solution_status.py    its status (ok, limited, ...); the rules and tolerances that decide it
    solution_file.py      saved solutions
    solution_reuse.py     the last solution, scaled for a multiple of its targets
    solution_tables.py    xarray and pandas
Evidence
    solution_check.py     violated limits, error, objective and proven bound, from the gains
    gain_evaluation.py    the same in double precision, for any gains
    felt_figures.py       force, rms, holes and spill of a region; the tolerances of `FeltRegion.even`
    felt_places.py        places between and beside the samples, where they are evaluated
    surface_force.py      force on a surface, along its normals
    error_lower_bound.py  a lower bound of the error for any phases
Kernels
    kernels.hpp           Gram matrix, Gerchberg-Saxton steps on it, limits
    matvec.hpp            products with B and B^H
    changed_rows.hpp      which rows of B have changed
    regions.hpp           the wave of a region: constants and phases; called by region_phases.py
    region_groups.hpp     samples that share one free phase
    non_finite.hpp        kernels that detect numbers that are not finite; phases of groups
"""
