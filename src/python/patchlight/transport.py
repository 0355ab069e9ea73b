"""Form factors as a scipy operator, and sensitivities by adjoint solutions."""
import numpy

from patchlight import _core


def operator_of(transport):
    """H = F B as a scipy.sparse.linalg.LinearOperator, with the transpose by reciprocity: F^T x = A o F (x / A)."""
    from scipy.sparse.linalg import LinearOperator

    size, area = transport.size, transport.area

    def apply(radiosity):
        return transport.apply(radiosity).reshape(numpy.shape(radiosity))

    def transposed(values):
        scale = area.reshape((-1,) + (1,) * (numpy.ndim(values) - 1))
        return scale * apply(numpy.asarray(values) / scale)

    return LinearOperator((size, size), matvec=apply, matmat=apply, rmatvec=transposed, rmatmat=transposed,
                          dtype=numpy.float64)


def sensitivities(transport, weights, tolerance=1e-10):
    """Derivatives of a mean irradiance Q = sum_i weights_i H_i by materials, from one adjoint solution.

    weights: a number for each patch; area / area.sum() over the patches of a floor gives its mean irradiance. Returns Q
    in W/m^2 per band and, per material and band, its derivatives by reflectance ("reflectance", W/m^2) and by exitance
    ("exitance", 1). With H = F B, B = E + rho o H the adjoint z = w / A + rho o F z gives dQ = (A o F z) . (dE + drho o H).
    """
    area = transport.area[:, None]
    weights = numpy.asarray(weights, dtype=float).reshape(-1, 1)
    lamps = numpy.broadcast_to(weights / area, transport.exitance.shape)
    # Weights of either sign are valid for the bounds of the solver.
    adjoint = transport.solve("cg", tolerance=tolerance, exitance=lamps).radiosity
    solution = transport.solve("cg", tolerance=tolerance)
    return {"value": (weights * solution.irradiance).sum(axis=0),
            **by_material(transport, area * transport.apply(adjoint), solution.irradiance)}


def sensor_sensitivities(transport, tolerance=1e-10):
    """The same for the irradiance of each sensor from patches, H_s = sum_i g_i B_i, with one adjoint solution per sensor.

    Returns a list with an entry for each sensor, in scene order. With the factors g of the sensor, the adjoint
    b = rho o g / A + rho o F b gives dH_s = A o (g / A + F b) . (dE + drho o H).
    """
    area, rho = transport.area[:, None], transport.reflectance
    solution = transport.solve("cg", tolerance=tolerance)
    entries = []
    for factors in transport.sensor_factors():
        factors = factors[:, None]
        adjoint = transport.solve("cg", tolerance=tolerance, exitance=rho * factors / area).radiosity
        entries.append({"value": (factors * solution.radiosity).sum(axis=0),
                        **by_material(transport, factors + area * transport.apply(adjoint), solution.irradiance)})
    return entries


def by_material(transport, by_radiosity, irradiance):
    """Derivatives by the exitance and reflectance of materials (rows) per band, from those by the radiosity of each patch:
    dQ = sum_i y_i (dE_i + drho_i H_i)."""
    count = int(transport.material.max()) + 1

    def summed(values):
        return numpy.array([numpy.bincount(transport.material, band, count) for band in values.T]).T

    emits = numpy.ones(transport.size) if transport.emits_from_back else (transport.front == 0).astype(float)
    return {"reflectance": summed(by_radiosity * irradiance), "exitance": summed(by_radiosity * emits[:, None])}


_core.Transport.operator = property(operator_of, doc="H = F B as a scipy.sparse.linalg.LinearOperator.")
_core.Transport.sensitivities = sensitivities
