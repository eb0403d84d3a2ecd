"""Common ancestors in a tree, and sums along its paths, in time logarithmic in its depth.

Each node stores its parent and one ancestor to jump to (E. W. Myers, *An applicative random-access stack*, 1983).
"""

from __future__ import annotations

from collections.abc import Sequence


class Ancestry:
    """The ancestors of the nodes of a tree.

    Nodes are numbered from 0, the root, and a parent has a lower number than its children, as in a Pinocchio
    model.
    """

    def __init__(self, parents: Sequence[int]) -> None:
        """``parents`` has the parent of each node; that of the root is 0."""
        self.parents = parents
        self._depth, self._jump = [0], [0]
        depth, jump = self._depth, self._jump
        for parent in parents[1:]:
            above = jump[parent]
            as_far = depth[parent] - depth[above] == depth[above] - depth[jump[above]]
            depth.append(depth[parent] + 1)
            jump.append(jump[above] if as_far else parent)

    def common(self, a: int, b: int) -> int:
        """The lowest node that is an ancestor of both, or one of the two."""
        depth, jump, parents = self._depth, self._jump, self.parents
        if depth[a] > depth[b]:
            a, b = b, a
        while depth[b] > depth[a]:
            b = jump[b] if depth[jump[b]] >= depth[a] else parents[b]
        while a != b:
            a, b = (jump[a], jump[b]) if jump[a] != jump[b] else (parents[a], parents[b])
        return a

    def sums(self, weights: Sequence[float]) -> list[float]:
        """For each node the sum of the weights from it to its jump target, excluding the target."""
        jump, parents, sums = self._jump, self.parents, [0.0]
        for node in range(1, len(parents)):
            parent = parents[node]
            over = 0.0 if jump[node] == parent else sums[parent] + sums[jump[parent]]
            sums.append(weights[node] + over)
        return sums

    def sum_to(self, node: int, ancestor: int, weights: Sequence[float], sums: Sequence[float]) -> float:
        """Sum of the weights from a node up to an ancestor, excluding the ancestor; ``sums`` as `sums` returns them."""
        depth, jump, total = self._depth, self._jump, 0.0
        while node != ancestor:
            if depth[jump[node]] >= depth[ancestor]:
                total, node = total + sums[node], jump[node]
            else:
                total, node = total + weights[node], self.parents[node]
        return total


class DisjointSets:
    """Numbers in sets that are joined: a union-find forest, nearly linear in what it is asked."""

    def __init__(self, count: int) -> None:
        """Take the number of numbers from 0 on, each a set of its own."""
        self._above = list(range(count))

    def find(self, number: int) -> int:
        """The number that stands for the set of this one."""
        above = self._above
        while above[number] != number:
            above[number] = above[above[number]]
            number = above[number]
        return number

    def join(self, number: int, other: int) -> None:
        """Make one set of those of two numbers; that of the other stands for it."""
        self._above[self.find(number)] = self.find(other)


def between(parents: Sequence[int], a: int, b: int) -> dict[int, float]:
    """The nodes between two, up to where their paths meet: +1 for those on the way to b, -1 for those to a."""
    signs = {}
    while a != b:
        if a > b:  # a parent has a lower index than its child
            signs[a], a = -1.0, parents[a]
        else:
            signs[b], b = 1.0, parents[b]
    return signs


def nodes_between(parents: Sequence[int], pairs: Sequence[tuple[int, int]]) -> list[int]:
    """The nodes between the two of any of some pairs, in order."""
    below = [0] * len(parents)  # of each node, a bit for each pair with one of its two in the node's subtree
    for bit, (a, b) in enumerate(pairs):
        below[a] ^= 1 << bit
        below[b] ^= 1 << bit
    for node in range(len(parents) - 1, 0, -1):
        below[parents[node]] ^= below[node]
    return [node for node in range(1, len(parents)) if below[node]]
