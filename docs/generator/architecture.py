# SPDX-License-Identifier: Apache-2.0
"""The parts of docs/architecture.md that are drawn from the code: the picture of the rooms and the table of them."""
from docs.generator import source_tree


def drawn_edges(edges):
    """The edges that no longer way says already."""
    return [(room, target) for room in sorted(edges) for target in sorted(edges[room])
            if not any(target in source_tree.reachable(edges, other) for other in edges[room] - {target})]


def picture(root):
    """A Mermaid flowchart: an arrow from each room to what it includes."""
    lines = ["```mermaid", "flowchart TD"]
    for hall in source_tree.HALLS:
        names = [room for room in source_tree.room_names(root) if room.startswith(f"{hall}/")]
        lines += [f"  subgraph {hall}", *(f"    {room.replace('/', '_')}[{room.split('/')[1]}]" for room in names), "  end"]
    lines += [f"  {room.replace('/', '_')} --> {target.replace('/', '_')}"
              for room, target in drawn_edges(source_tree.room_edges(root))]
    return "\n".join([*lines, "```"])


def table(root):
    """What each room is, what it includes of ours, and which libraries."""
    edges, libraries = source_tree.room_edges(root), source_tree.room_libraries(root)
    lines = ["| room | what it is | includes | libraries |", "|---|---|---|---|"]
    for room in source_tree.room_names(root):
        ours = ", ".join(f"`{other}`" for other in sorted(edges.get(room, ()))) or "–"
        theirs = ", ".join(sorted(libraries[room], key=str.lower)) or "–"
        lines.append(f"| `{room}` | {source_tree.purpose(root, room) or ''} | {ours} | {theirs} |")
    return "\n".join(lines)
