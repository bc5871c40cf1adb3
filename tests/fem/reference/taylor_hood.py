"""Finite elasticity of incompressible fibre-reinforced tissue in dolfinx 0.5 (Debian: python3-dolfinx-real).

Shared by the scripts of this folder. Units: N, mm, MPa. Unknowns: displacement u and pressure p (tension positive:
the energy's term is p (J - 1)), elements of any family; the linear systems go to MUMPS, as LDL' whose inertia tells
stability, or as LU where a follower load makes the tangent unsymmetric.
"""
import logging
import os
import resource

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import numpy as np
import ufl
from dolfinx import fem, mesh
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

logging.disable(logging.INFO)
JIT = {"cffi_extra_compile_args": ["-O3", "-march=native"]}

# Parameter sets, MPa; active stress sigma_max f_l(lambda) is nominal (per reference area).
BLOCK_MUSCLE = dict(c1=0.00356, c2=0.00386, c3=3.57e-8, c4=42.6, sigma_max=0.3, lambda_opt=1.2,
                    dW_asc=0.25, nu_asc=3.0, dW_desc=0.15, nu_desc=4.0)
SPRENGER_MUSCLE = dict(c1=3.56463903963e-2, c2=3.859558659683e-3, c3=3.05907e-10, c4=47.270456264135881,
                       sigma_max=0.3, lambda_opt=1.4, dW_asc=0.57, nu_asc=4.0, dW_desc=0.14, nu_desc=3.0)
SPRENGER_TENDON = dict(c1=2.31, c2=1.15e-6, c3=7.99, c4=16.6)


def ground_energy(F, p, m):
    """W = c1 (I1 - 3) + c2 (I2 - 3) - (2 c1 + 4 c2) ln J + p (J - 1), stress-free at F = 1, p = 0."""
    C, J = F.T * F, ufl.det(F)
    i1 = ufl.tr(C)
    i2 = (i1**2 - ufl.tr(C * C)) / 2
    return m["c1"] * (i1 - 3) + m["c2"] * (i2 - 3) - (2 * m["c1"] + 4 * m["c2"]) * ufl.ln(J) + p * (J - 1)


def fibre_nominal_stress(lam, m, alpha=None):
    """dW/dlambda = c3/lambda (lambda^c4 - 1) [lambda >= 1] + alpha sigma_max f_l(lambda)."""
    stress = ufl.conditional(ufl.ge(lam, 1.0), m["c3"] / lam * (lam ** m["c4"] - 1), 0.0)
    if alpha is not None:
        x = lam / m["lambda_opt"] - 1
        rise = ufl.exp(-((ufl.max_value(-x, 0.0) / m["dW_asc"]) ** m["nu_asc"]))
        fall = ufl.exp(-((ufl.max_value(x, 0.0) / m["dW_desc"]) ** m["nu_desc"]))
        stress += alpha * m["sigma_max"] * rise * fall  # one of the two factors is 1
    return stress


def tissue_stress(F, p, m, a0, alpha=None):
    """First Piola-Kirchhoff stress; the fibre part is g(lambda)/lambda (F a0) x a0."""
    Fv = ufl.variable(F)
    a = F * a0
    lam = ufl.sqrt(ufl.inner(a, a))
    return ufl.diff(ground_energy(Fv, p, m), Fv) + fibre_nominal_stress(lam, m, alpha) / lam * ufl.outer(a, a0)


def block(lengths, cells, tetrahedra=False):
    kind = mesh.CellType.tetrahedron if tetrahedra else mesh.CellType.hexahedron
    return mesh.create_box(MPI.COMM_SELF, [[0.0, 0.0, 0.0], list(lengths)], list(cells), cell_type=kind)


def cpu_s():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def peak_mb():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


class Problem:
    """Mixed boundary-value problem: residual = residual_of(u, p, v, q, dx, ds), Newton, MUMPS."""

    def __init__(self, domain, residual_of, orders=(2, 1), pressure="Lagrange", quadrature_degree=5,
                 facet_tags=None, symmetric=True):
        self.domain = domain
        cell = domain.ufl_cell()
        element = ufl.MixedElement([ufl.VectorElement("Lagrange", cell, orders[0]),
                                    ufl.FiniteElement(pressure, cell, orders[1])])
        self.W = fem.FunctionSpace(domain, element)
        self.w = fem.Function(self.W)
        self.bcs, self.symmetric = [], symmetric
        u, p = ufl.split(self.w)
        v, q = ufl.TestFunctions(self.W)
        meta = {"quadrature_degree": quadrature_degree}
        dx = ufl.Measure("dx", domain=domain, metadata=meta)
        ds = ufl.Measure("ds", domain=domain, subdomain_data=facet_tags, metadata=meta)
        residual = residual_of(u, p, v, q, dx, ds)
        self.residual = fem.form(residual, jit_params=JIT)
        self.tangent = fem.form(ufl.derivative(residual, self.w), jit_params=JIT)
        self.A = petsc.create_matrix(self.tangent)
        self.b = petsc.create_vector(self.residual)
        self.dw = self.b.duplicate()
        self.ksp = PETSc.KSP().create(MPI.COMM_SELF)
        self.ksp.setOperators(self.A)
        self.ksp.setType("preonly")
        pc = self.ksp.getPC()
        pc.setType("cholesky" if symmetric else "lu")
        pc.setFactorSolverType("mumps")
        if symmetric:
            self.A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        options = PETSc.Options()
        options["mat_mumps_icntl_7"] = 5    # METIS
        options["mat_mumps_icntl_14"] = 60  # room for delayed pivots, %
        pc.setFactorSetUpSolverType()
        pc.getFactorMatrix().setFromOptions()
        self.factorisations = 0
        self.iterations = 0
        # dofs of each displacement component: number in W and reference place
        self.component = []
        for i in range(domain.geometry.dim):
            Vi, numbers = self.W.sub(0).sub(i).collapse()
            self.component.append((np.asarray(numbers), Vi.tabulate_dof_coordinates()))
        self.pressure_dofs = np.asarray(self.W.sub(1).collapse()[1])

    @property
    def unknowns(self):
        return self.W.dofmap.index_map.size_global

    def fix(self, where, component, value):
        """u_component = value (a fem.Constant, changed between steps) at the nodes where(x) (x of shape (3, n))."""
        Wi = self.W.sub(0).sub(component)
        numbers, x = self.component[component]
        dofs = numbers[where(x.T)].astype(np.int32)
        self.bcs.append(fem.dirichletbc(value, dofs, Wi))
        return dofs

    def constant(self, value=0.0):
        return fem.Constant(self.domain, PETSc.ScalarType(value))

    def assemble_residual(self):
        with self.b.localForm() as local:
            local.set(0.0)
        petsc.assemble_vector(self.b, self.residual)
        return self.b

    def assemble_tangent(self):
        self.A.zeroEntries()
        petsc.assemble_matrix(self.A, self.tangent, bcs=self.bcs)
        self.A.assemble()

    def factorise_tangent(self):
        self.ksp.getPC().setUp()  # KSP would leave it to the next solve
        self.factorisations += 1

    def factorise(self):
        self.assemble_tangent()
        self.factorise_tangent()

    def step(self, rtol=1e-10, max_iterations=30):
        """Newton from the present state to the present boundary values and loads. The residual at free dofs is taken
        relative to the first right-hand side of the step (which contains the boundary values' jump)."""
        x = self.w.vector
        history, first = [], None
        for k in range(max_iterations):
            forces = self.assemble_residual().norm()  # reactions included
            if k == 0:  # later the boundary values are met
                petsc.apply_lifting(self.b, [self.tangent], bcs=[self.bcs], x0=[x], scale=-1.0)
            petsc.set_bc(self.b, self.bcs, x, -1.0)
            size = self.free_norm()
            first = first or size
            history.append(size / first if first > 0 else 0.0)
            if not np.isfinite(size) or history[-1] > 1e6:
                raise RuntimeError(f"diverged: {history}")
            rounding = size < 1e-12 * forces or (k > 2 and history[-1] < 1e-8 and history[-1] > 0.5 * history[-2])
            if (k > 0 and history[-1] < rtol) or size < 1e-14 or rounding:
                return history
            self.factorise()
            self.ksp.solve(self.b, self.dw)
            x.axpy(-1.0, self.dw)
            self.iterations += 1
        raise RuntimeError(f"not converged: {history}")

    def free_norm(self):
        values = self.b.array.copy()
        for bc in self.bcs:
            values[bc.dof_indices()[0]] = 0.0
        return np.linalg.norm(values)

    def negative_modes(self):
        """Negative eigenvalues of the tangent beyond those of the pressure rows (Sylvester: a stable state has 0)."""
        self.factorise()
        return self.ksp.getPC().getFactorMatrix().getMumpsInfog(12) - len(self.pressure_dofs)

    def factor_size(self):
        factor = self.ksp.getPC().getFactorMatrix()
        nonzeros = factor.getMumpsInfog(29)
        return (nonzeros if nonzeros > 0 else -nonzeros * 10**6), factor.getMumpsRinfog(3)

    def reaction(self, where, about=None):
        """Resultant of the consistent nodal forces that hold the nodes where(X), and its moment about a point (deformed
        place of the nodes)."""
        values = self.assemble_residual().array
        w = self.w.vector.array
        dim = len(self.component)
        picks = [np.flatnonzero(where(x.T)) for _, x in self.component]
        force = np.array([values[self.component[i][0][picks[i]]].sum() for i in range(dim)])
        if about is None:
            return force
        moment = np.zeros(3)
        place = self.component[0][1][picks[0]].copy()
        nodal = np.zeros((len(picks[0]), 3))
        for i in range(dim):
            numbers = self.component[i][0][picks[i]]
            assert np.allclose(self.component[i][1][picks[i]], self.component[0][1][picks[0]])
            place[:, i] += w[numbers]
            nodal[:, i] = values[numbers]
        moment = np.cross(place - np.asarray(about), nodal).sum(axis=0)
        return force, moment

    def displacement_at(self, point):
        values = []
        for numbers, x in self.component:
            d = np.abs(x[:, :3] - np.asarray(point)).max(axis=1)
            i = int(d.argmin())
            assert d[i] < 1e-9, "no node there"
            values.append(self.w.vector.array[numbers[i]])
        return np.array(values)

    def volume_ratio(self):
        u = ufl.split(self.w)[0]
        J = ufl.det(ufl.Identity(self.domain.geometry.dim) + ufl.grad(u))
        dx = ufl.Measure("dx", domain=self.domain, metadata={"quadrature_degree": 6})
        one = fem.assemble_scalar(fem.form(fem.Constant(self.domain, 1.0) * dx))
        return fem.assemble_scalar(fem.form(J * dx)) / one


def tissue_problem(domain, muscle, a0, alpha, **options):
    """Homogeneous tissue with constant fibre direction a0; alpha: fem.Constant on the domain."""

    def residual(u, p, v, q, dx, ds):
        F = ufl.Identity(3) + ufl.grad(u)
        P = tissue_stress(F, p, muscle, ufl.as_vector(a0), alpha)
        return ufl.inner(P, ufl.grad(v)) * dx + q * (ufl.det(F) - 1) * dx

    return Problem(domain, residual, **options)


def clamp_ends(problem, length):
    """Both ends x = 0 and x = length fully held; returns the right end's displacement (constants x, y, z)."""
    zero = problem.constant()
    moved = [problem.constant() for _ in range(3)]
    for i in range(3):
        problem.fix(lambda x: np.isclose(x[0], 0.0), i, zero)
        problem.fix(lambda x: np.isclose(x[0], length), i, moved[i])
    return moved


def richardson(sizes, values):
    """(limit, order, error of the finest) from three values on meshes refined by one ratio; order by the ratio of
    differences."""
    (h1, h2, h3), (f1, f2, f3) = sizes[-3:], values[-3:]
    ratio = (f2 - f1) / (f3 - f2) if f3 != f2 else np.inf
    if not ratio > 1:
        return f3, np.nan, abs(f3 - f2)
    from scipy.optimize import brentq
    order = brentq(lambda q: (h1**q - h2**q) / (h2**q - h3**q) - ratio, 0.05, 12) if ratio > np.log(h1 / h2) / np.log(
        h2 / h3) * 1.001 else np.nan
    if not np.isfinite(order):
        return f3, np.nan, abs(f3 - f2)
    limit = f3 + (f3 - f2) * h3**order / (h2**order - h3**order)
    return limit, order, abs(limit - f3)
