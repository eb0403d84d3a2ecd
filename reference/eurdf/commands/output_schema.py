"""Schemas of the JSON outputs of the commands; ``python -m eurdf.commands.output_schema FOLDER`` writes them."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any


def output_schemas() -> dict[str, dict[str, Any]]:
    """JSON Schema (2020-12) of each command's JSON, by file name."""
    from eurdf.commands.assembly_info import assembly_schema
    from eurdf.commands.collection_info import collection_schema
    from eurdf.commands.export_info import export_schema
    from eurdf.commands.import_info import import_schema
    from eurdf.commands.robot_info import info_schema
    from eurdf.commands.serial_info import serial_schema
    from eurdf.commands.transmission_info import transmission_schema
    from eurdf.diagnostics.report import report_schema

    return {
        "assemble.schema.json": assembly_schema(),
        "diagnostics-report.schema.json": report_schema(),
        "export.schema.json": export_schema(),
        "import.schema.json": import_schema(),
        "info.schema.json": info_schema(),
        "robots.schema.json": collection_schema(),
        "serial.schema.json": serial_schema(),
        "transmission.schema.json": transmission_schema(),
    }


def schema_text(schema: dict[str, Any]) -> str:
    """The text of the schema file."""
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def main(folder: str) -> None:
    """Write every schema into a folder."""
    for name, schema in output_schemas().items():
        Path(folder, name).write_text(schema_text(schema), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
