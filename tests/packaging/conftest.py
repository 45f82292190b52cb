"""FMUs built once."""

import pytest
from fmpy import extract

from dcone_cosim.build import cache_folder
from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds
from tests.packaging import toy
from tests.packaging.driven import CASES, TERMS, VARIANTS
from tests.packaging.raw import OK, Library, Raw


@pytest.fixture(scope="session")
def fmu(tmp_path_factory):
    """Path and unpacked folder of an FMU, by model or variant, in the cache where runs find it too."""
    made = {}

    def make(name):
        if name not in made:
            model, terms = VARIANTS.get(name) or (name, TERMS[name])
            path = builds.build(MODELS[model].interface(terms), cache_folder())
            made[name] = (path, str(extract(str(path), unzipdir=str(tmp_path_factory.mktemp(name)))))
        return made[name]

    return make


@pytest.fixture(params=list(CASES))
def case(request, fmu):
    terms, parameters, step, count = CASES[request.param]
    return request.param, *fmu(request.param), terms, parameters, step, count


@pytest.fixture(scope="session")
def built_toy(tmp_path_factory):
    """The toy's library."""
    return toy.build(tmp_path_factory.mktemp("toy"))


@pytest.fixture(scope="session")
def library(built_toy):
    return Library(built_toy.library)


@pytest.fixture
def make(built_toy, library):
    """Make instances of the toy, freed at the end."""
    made = []

    def new(**more):
        made.append(Raw(library, **{"guid": built_toy.guid, "names": built_toy.references, **more}))
        return made[-1]

    yield new
    for raw in made:
        raw.free()


@pytest.fixture
def running(make):
    """An instance of the toy that is initialised."""
    raw = make()
    assert raw.start() == OK
    return raw
