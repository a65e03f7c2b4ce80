"""Which modules import which, read off their texts, and whether that goes in a circle."""

import ast


def sources_of(files, root):
    """Return the texts of files by the names of their modules, which are below a folder."""
    return {module_of(path, root): path.read_text(encoding="utf-8") for path in files}


def module_of(path, root):
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def arrows(sources):
    """Return which modules each module imports, for types alone as well; sources are texts by modules."""
    return {name: set(imported_modules(ast.parse(text), sources)) - {name} for name, text in sources.items()}


def imported_modules(tree, modules):
    """Yield those of some modules that a file imports, wherever in it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in modules)
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                if inner in modules or node.module in modules:
                    yield inner if inner in modules else node.module


def circles(graph):
    """Return the modules that are left when again and again those are taken away that import none of the others."""
    left = {name: set(others) for name, others in graph.items()}
    while ends := [name for name, others in left.items() if not others & left.keys()]:
        for name in ends:
            del left[name]
    return sorted(left)
