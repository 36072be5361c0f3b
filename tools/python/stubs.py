"""Writes the type stubs of the module `ukemi`, as the signatures of its docstrings have them: stubs.py FILE.pyi"""
import inspect
import os
import re
import sys

import ukemi


def typed(text):
    """Types as a stub names them."""
    text = re.sub(r"\bukemi\.", "", text)
    text = re.sub(r"numpy\.ndarray\[[^\[\]]*(?:\[[^\[\]]*\])?[^\[\]]*\]", "NDArray[numpy.float64]", text)
    return re.sub(r"\b([A-Z]\w*)(\[|\b)", lambda m: m[0].lower() if m[1] in ("List", "Dict", "Tuple") else m[0], text)


def signature_and_words(doc):
    first, _, words = (doc or "").partition("\n")
    return typed(first), words.strip()


def definition(doc, indent):
    signature, words = signature_and_words(doc)
    signature = re.sub(r"\bself: \w+", "self", signature)
    return f'{indent}def {signature}:\n{indent}    """{words}"""\n'


def function(name, doc, indent):
    """A function, or each of its overloads: pybind11 numbers them, "2. name(...) -> ..."."""
    if "Overloaded function." not in doc:
        return definition(doc, indent)
    each = re.split(rf"^\d+\. (?={name}\()", doc, flags=re.MULTILINE)[1:]
    return "".join(f"{indent}@overload\n{definition(d, indent)}" for d in each)


def class_(name, c):
    bases = [b.__name__ for b in c.__bases__ if b is not object and not b.__name__.startswith("pybind11")]
    out = f"class {name}({', '.join(bases)}):\n" if bases else f"class {name}:\n"
    out += f'    """{inspect.cleandoc(c.__doc__ or "")}"""\n'
    if hasattr(c, "__members__"):
        return out + "".join(f"    {m}: {name}\n" for m in c.__members__)
    for key, value in sorted(vars(c).items()):
        if isinstance(value, property):
            signature, words = signature_and_words(value.fget.__doc__)
            words = value.__doc__ or words
            result = signature.rpartition("-> ")[2] or "object"
            out += f'    @property\n    def {key}(self) -> {result}:\n        """{words}"""\n'
        elif isinstance(value, staticmethod):
            out += "    @staticmethod\n" + function(key, getattr(c, key).__doc__, "    ")
        elif callable(value) and (not key.startswith("__") or key == "__init__" or key == "__float__"):
            if value.__doc__ and "->" in value.__doc__:
                out += function(key, value.__doc__, "    ")
    return out


def stubs():
    out = f'"""{ukemi.__doc__}"""\nimport os\nfrom typing import Callable, Optional, Union, overload\n\nimport numpy\nfrom numpy.typing import NDArray\n\n'
    out += "__version__: str\n\n"
    for name, value in sorted(vars(ukemi).items()):
        if name.startswith("_"):
            continue
        out += class_(name, value) if inspect.isclass(value) else function(name, value.__doc__, "")
        out += "\n"
    return out


os.makedirs(os.path.dirname(os.path.abspath(sys.argv[1])), exist_ok=True)
with open(sys.argv[1], "w", encoding="utf-8") as f:
    f.write(stubs())
