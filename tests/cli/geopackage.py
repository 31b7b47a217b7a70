"""geopackage.py FILE [log|view|text|comment|name]: a GeoPackage with two street lamps, made by SQLite alone.

log: a third lamp is in a write-ahead log beside it; view: a layer that never ends; text: a virtual table over the file
PIPE; comment, name: the same with a comment before VIRTUAL, or in the place of its name.
"""
import os
import shutil
import sqlite3
import struct
import sys

WGS84 = ('GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
         'UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]')
TABLES = """
CREATE TABLE gpkg_spatial_ref_sys(srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY,
  organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents(table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '', last_change DATETIME NOT NULL DEFAULT '2026-01-01T00:00:00Z', min_x DOUBLE, min_y DOUBLE,
  max_x DOUBLE, max_y DOUBLE, srs_id INTEGER);
CREATE TABLE gpkg_geometry_columns(table_name TEXT NOT NULL, column_name TEXT NOT NULL,
  geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL);
CREATE TABLE lamps(fid INTEGER PRIMARY KEY, geom BLOB, highway TEXT);
"""
LAYER = """
INSERT INTO gpkg_contents(table_name, data_type, identifier, srs_id) VALUES('{0}', 'features', '{0}', 4326);
INSERT INTO gpkg_geometry_columns VALUES('{0}', 'geom', 'POINT', 4326, 0, 0);
"""
VIRTUAL = {"text": "CREATE VIRTUAL TABLE spy", "comment": "CREATE /**/ VIRTUAL TABLE spy",
           "name": "CREATE VIRTUAL TABLE spy/* USING rtree( */"}
ENDLESS = """
CREATE VIEW slow AS WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM r WHERE n < 100000000000)
  SELECT count(*) AS fid, (SELECT geom FROM lamps) AS geom, 'street_lamp' AS highway FROM r;
"""


def add(db, fid, lon, lat):
    point = b"GP\0\1" + struct.pack("<i", 4326) + b"\1" + struct.pack("<Idd", 1, lon, lat)
    db.execute("INSERT INTO lamps VALUES(?, ?, 'street_lamp')", (fid, point))


def main(path, kind=""):
    db = sqlite3.connect(path)
    db.execute("PRAGMA application_id = 1196444487")
    db.execute("PRAGMA user_version = 10300")
    db.executescript(TABLES + LAYER.format("lamps"))
    db.execute("INSERT INTO gpkg_spatial_ref_sys VALUES('WGS 84', 4326, 'EPSG', 4326, ?, '')", (WGS84,))
    add(db, 1, 11.42, 48.76)
    add(db, 2, 11.4201, 48.76)
    if kind == "view":
        db.executescript(ENDLESS + LAYER.format("slow"))
    # what spatialite would open; SQLite itself knows no such module, so it is written into the schema
    if kind in VIRTUAL:
        db.execute("PRAGMA writable_schema = ON")
        sql = VIRTUAL[kind] + " USING VirtualText('PIPE', 'UTF-8')"
        db.execute("INSERT INTO sqlite_master VALUES('table', 'spy', 'spy', 0, ?)", (sql,))
    db.commit()
    if kind == "log":
        db.execute("PRAGMA journal_mode = WAL")
        add(db, 3, 11.4202, 48.76)
        db.commit()
        for end in ("", "-wal"):  # closing would write the log into the file
            shutil.copy(path + end, path + ".kept" + end)
    db.close()
    if kind == "log":
        for end in ("", "-wal"):
            os.replace(path + ".kept" + end, path + end)


main(*sys.argv[1:])
