"""XML of other programs as a tree that knows where in the file each element stands.

Files are untrusted: a document type, from which entities come, is refused before anything of it is
used, and so are a file that is too large and elements too deep in each other.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from surae.base.errors import InputError
from surae.base.files import PathLike, read_bytes, shown

#: Largest file [bytes]; whole-body models with all their curves have some 2 MB.
LARGEST = 64 * 2**20
#: Elements within each other, and elements in all.
_DEEPEST = 100
_MOST = 2_000_000


@dataclass(slots=True, eq=False)
class Node:
    """An element of a file."""

    tag: str
    attributes: dict[str, str]
    start: int  #: Where it begins in the file [bytes].
    end: int = 0  #: Where what follows it begins [bytes].
    text: str = ""  #: What stands in it and in no element of it.
    children: list["Node"] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Its attribute ``name``; empty where it has none."""
        return self.attributes.get("name", "")

    def find(self, tag: str) -> "Node | None":
        """The first element right in it with a tag."""
        return next((child for child in self.children if child.tag == tag), None)

    def all(self, *tags: str) -> Iterator["Node"]:
        """Every element in it, however deep, with one of some tags; of none, every one."""
        waiting = self.children[::-1]
        while waiting:
            node = waiting.pop()
            if not tags or node.tag in tags:
                yield node
            waiting.extend(reversed(node.children))

    def said(self, *tags: str) -> str:
        """Text of the first element right in it that has one of some tags; empty without one."""
        for tag in tags:
            if (node := self.find(tag)) is not None:
                return node.text.strip()
        return ""

    def numbers(self, *tags: str) -> tuple[float, ...]:
        """Numbers of the first element right in it that has one of some tags."""
        text = self.said(*tags)
        try:
            return tuple(map(float, text.split()))
        except ValueError:
            raise InputError(f"<{tags[0]}> of {self.name or self.tag} is not of numbers") from None

    def number(self, *tags: str) -> float | None:
        """The number of the first element right in it that has one of some tags."""
        numbers = self.numbers(*tags)
        return numbers[0] if len(numbers) == 1 else None


def read_xml(path: PathLike) -> tuple[Node, bytes]:
    """The outermost element of a file, and the file's content."""
    data = read_bytes(path, LARGEST)
    return parse_xml(data, shown(path)), data


def parse_xml(data: bytes, where: str) -> Node:
    """The outermost element of XML; `where` it is from stands in what is said against it."""
    document = Node("", {}, 0)
    path = [document]
    count = [0]
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def begin(tag: str, attributes: dict[str, str]) -> None:
        count[0] += 1
        if len(path) > _DEEPEST or count[0] > _MOST:
            raise InputError(f"{where}: its XML has more elements than a model has")
        node = Node(tag, attributes, parser.CurrentByteIndex)
        path[-1].children.append(node)
        path.append(node)

    def finish(tag: str) -> None:
        del tag
        path.pop().end = _after(data, parser.CurrentByteIndex)

    def text(words: str) -> None:
        path[-1].text += words

    def refuse(*given: object) -> None:
        del given
        raise InputError(
            f"{where}: its XML declares a document type; take the lines <!DOCTYPE …> out of it"
        )

    parser.StartElementHandler = begin
    parser.EndElementHandler = finish
    parser.CharacterDataHandler = text
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise InputError(
            f"{where}: row {error.lineno}: not XML ({expat.ErrorString(error.code)})"
        ) from None
    except InputError:
        raise
    except (ValueError, LookupError):
        raise InputError(f"{where}: not XML: its encoding is not known; use UTF-8") from None
    return document.children[0]


def _after(data: bytes, start: int) -> int:
    """Where a tag that begins at `start` is over; an attribute's value may hold ``>``."""
    quote = 0
    for at in range(start, len(data)):
        byte = data[at]
        if quote:
            quote = 0 if byte == quote else quote
        elif byte in b"\"'":
            quote = byte
        elif byte == ord(">"):
            return at + 1
    return len(data)
