"""Writes values as the XML encoding of OPC UA (Part 6) and knows the units of the models."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from xml.sax.saxutils import escape

from address_space import UANODESET, UATYPES, NodeSetError

UNIT_URI = "http://www.opcfoundation.org/UA/units/un/cefact"

# UNECE common code (empty: none exists), description.
UNITS = {
    "m": ("MTR", "metre"),
    "rad": ("C81", "radian"),
    "s": ("SEC", "second"),
    "ms": ("C26", "millisecond"),
    "N": ("NEW", "newton"),
    "N·m": ("NU", "newton metre"),
    "m/s": ("MTS", "metre per second"),
    "rad/s": ("2A", "radian per second"),
    "m/s²": ("MSK", "metre per second squared"),
    "rad/s²": ("2B", "radian per second squared"),
    "m/s³": ("", "metre per second cubed"),
    "rad/s³": ("", "radian per second cubed"),
    "kg": ("KGM", "kilogram"),
    "kg·m²": ("B32", "kilogram metre squared"),
    "°C": ("CEL", "degree Celsius"),
    "%": ("P1", "per cent"),
    "1": ("C62", "one"),
}

INTEGERS = ("SByte", "Byte", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
# NodeIds of the XML encodings.
ENCODING_IDS = {"Range": 885, "EUInformation": 888, "Argument": 297, "3DFrame": 18859, "3DVector": 18853}


def unit_id(code: str) -> int:
    """The UnitId of a UNECE common code: its characters as one big-endian number; -1 for none."""
    return int.from_bytes(code.encode("ascii"), "big") if code else -1


def engineering_units(symbol: str) -> dict:
    if symbol not in UNITS:
        raise NodeSetError(f"unit '{symbol}' is not known (known: {', '.join(UNITS)})")
    code, description = UNITS[symbol]
    return {"code": code, "symbol": symbol, "description": description}


def _localized(tag: str, text: str) -> str:
    return f"<{tag}><Locale>en</Locale><Text>{escape(text)}</Text></{tag}>"


def _numbers(names: str, values: list) -> str:
    return "".join(f"<{n}>{float(v)!r}</{n}>" for n, v in zip(names, values))


def _range(value: list) -> str:
    return f"<Range><Low>{float(value[0])!r}</Low><High>{float(value[1])!r}</High></Range>"


def _units(value: dict) -> str:
    return (
        f"<EUInformation><NamespaceUri>{UNIT_URI}</NamespaceUri>"
        f"<UnitId>{unit_id(value['code'])}</UnitId>{_localized('DisplayName', value['symbol'])}"
        f"{_localized('Description', value['description'])}</EUInformation>"
    )


def _argument(value: dict) -> str:
    dimensions = "<ArrayDimensions/>"
    if value["rank"] > 0:
        sizes = "<UInt32>0</UInt32>" * value["rank"]
        dimensions = f"<ArrayDimensions>{sizes}</ArrayDimensions>"
    return (
        f"<Argument><Name>{escape(value['name'])}</Name>"
        f"<DataType><Identifier>{value['data_type']}</Identifier></DataType>"
        f"<ValueRank>{value['rank']}</ValueRank>{dimensions}"
        f"{_localized('Description', value['doc'])}</Argument>"
    )


def _frame(value: list) -> str:
    return (
        f"<ThreeDFrame><CartesianCoordinates>{_numbers('XYZ', value[:3])}</CartesianCoordinates>"
        f"<Orientation>{_numbers('ABC', value[3:])}</Orientation></ThreeDFrame>"
    )


def _vector(value: list) -> str:
    return f"<ThreeDVector>{_numbers('XYZ', value)}</ThreeDVector>"


BODIES = {"Range": _range, "EUInformation": _units, "Argument": _argument, "3DFrame": _frame, "3DVector": _vector}


def _structure(data_type: str, value) -> str:
    return (
        f"<ExtensionObject><TypeId><Identifier>i={ENCODING_IDS[data_type]}</Identifier></TypeId>"
        f"<Body>{BODIES[data_type](value)}</Body></ExtensionObject>"
    )


def _scalar(data_type: str, value) -> str:
    if data_type in BODIES:
        return _structure(data_type, value)
    if data_type == "LocalizedText":
        return _localized("LocalizedText", value)
    if data_type == "NodeId":
        return f"<NodeId><Identifier>{value}</Identifier></NodeId>"
    if data_type == "Boolean":
        return f"<Boolean>{'true' if value else 'false'}</Boolean>"
    if data_type in ("Double", "Float"):
        return f"<{data_type}>{float(value)!r}</{data_type}>"
    if data_type in INTEGERS:
        return f"<{data_type}>{int(value)}</{data_type}>"
    return f"<{data_type}>{escape(str(value))}</{data_type}>"


def encode(data_type: str, value) -> str:
    """The content of a Value element for a builtin or known structure type; lists become arrays."""
    is_array = isinstance(value, list) and not (
        data_type in ("Range", "3DFrame", "3DVector") and not (value and isinstance(value[0], list))
    )
    if not is_array:
        text = _scalar(data_type, value)
    else:
        tag = "ExtensionObject" if data_type in BODIES else data_type
        text = f"<ListOf{tag}>{''.join(_scalar(data_type, v) for v in value)}</ListOf{tag}>"
    return text.replace(">", f' xmlns="{UATYPES}">', 1)


def element(data_type: str, value) -> ElementTree.Element:
    """A Value element of a NodeSet file."""
    if not data_type:
        raise NodeSetError(f"no encoding is known for the value {value!r}")
    return ElementTree.fromstring(f'<Value xmlns="{UANODESET}">{encode(data_type, value)}</Value>')


DEFAULTS = {"Boolean": False, "String": "", "LocalizedText": "", "Range": [0, 0], "DateTime": "1601-01-01T00:00:00Z",
            "NodeId": "i=0", "3DFrame": [0] * 6, "3DVector": [0] * 3}


def default_element(data_type: str, rank: int, length: int) -> ElementTree.Element | None:
    """Zero, empty or false: what an instance holds until the server writes to it; None if it has none.

    Arrays of 3DFrame and 3DVector have none: open62541's compiler cannot write them.
    """
    value = DEFAULTS.get(data_type, 0 if data_type in (*INTEGERS, "Double", "Float") else None)
    if value is None or rank > 1 or (rank == 1 and data_type in ("3DFrame", "3DVector")):
        return None
    if rank < 1:
        return element(data_type, value)
    return element(data_type, [value] * length) if length else None
