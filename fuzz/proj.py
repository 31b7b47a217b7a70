#!/usr/bin/env python3
"""proj.py FOLDER: FOLDER/proj.db, a hundredth of PROJ's database, and what the seeds' CRSs need: PROJ reads whole
tables of it for each definition that it is given, and fuzzers give it many. An empty folder where PROJ's is not
found."""
import ctypes, ctypes.util, os, shutil, sqlite3, sys

codes = """2056 21781 2154 2263 25831 25832 25833 27700 27572 28992 3035 3057 3068 31466 31467 31468 31469 32631 32632
    32633 3395 3857 5513 5514 7415"""
vertical = "3855 5709 5773 5783 7837 5728"
geodetic = "4258 4326 4937 4936 4978 4979 4314 4289 4156 4150 4149 4277 4275 4807 4818"


def database():
    proj = ctypes.CDLL(ctypes.util.find_library("proj"))
    proj.proj_context_create.restype = ctypes.c_void_p
    proj.proj_context_get_database_path.restype = ctypes.c_char_p
    return proj.proj_context_get_database_path(ctypes.c_void_p(proj.proj_context_create())).decode()


os.makedirs(sys.argv[1], exist_ok=True)
path = os.path.join(sys.argv[1], "proj.db")
try:
    shutil.copyfile(database(), path)
except (OSError, TypeError, AttributeError):
    sys.exit()
db = sqlite3.connect(path)
listed = lambda text: "(" + ",".join("'%s'" % c for c in text.split()) + ")"
some = "CAST(code AS INTEGER) % 100 <> 0 AND NOT (auth_name = 'EPSG' AND code IN "
triggers = db.execute("SELECT name FROM sqlite_master WHERE type = 'trigger'")
db.executescript("".join("DROP TRIGGER %s;" % name for name, in triggers))


def keep(table, column, *of):
    """Of a table the rows that others name."""
    named = " UNION ".join("SELECT %s_auth_name || ':' || %s_code FROM %s" % (c, c, t) for t, c in of)
    db.execute("DELETE FROM %s WHERE %sauth_name || ':' || %scode NOT IN (%s)" % (table, column, column, named))


db.execute("DELETE FROM projected_crs WHERE " + some + listed(codes) + ")")
db.execute("DELETE FROM vertical_crs WHERE " + some + listed(vertical) + ")")
db.execute("DELETE FROM geodetic_crs WHERE auth_name <> 'OGC' AND " + some + listed(geodetic) +
           ") AND auth_name || ':' || code "
           "NOT IN (SELECT geodetic_crs_auth_name || ':' || geodetic_crs_code FROM projected_crs)")
db.execute("DELETE FROM compound_crs WHERE vertical_crs_code NOT IN (SELECT code FROM vertical_crs) OR horiz_crs_code "
           "NOT IN "
           "(SELECT code FROM projected_crs UNION SELECT code FROM geodetic_crs)")
for kind, crs in ("geodetic", "geodetic_crs"), ("vertical", "vertical_crs"):
    members = kind + "_datum_ensemble_member"
    keep(kind + "_datum", "", (crs, "datum"), (members, "ensemble"), (members, "member"))
keep("conversion_table", "", ("projected_crs", "conversion"))
crs = "SELECT auth_name || ':' || code FROM crs_view"
for table in "helmert_transformation_table", "grid_transformation", "other_transformation", "concatenated_operation":
    for end in "source", "target":
        db.execute("DELETE FROM %s WHERE %s_crs_auth_name || ':' || %s_crs_code NOT IN (%s)" % (table, end, end, crs))
kept = "SELECT auth_name || ':' || code FROM coordinate_operation_view"
db.execute("DELETE FROM concatenated_operation WHERE auth_name || ':' || code IN (SELECT operation_auth_name || ':' || "
           "operation_code "
           "FROM concatenated_operation_step WHERE step_auth_name || ':' || step_code NOT IN (%s))" % kept)
db.execute("DELETE FROM concatenated_operation_step WHERE operation_auth_name || ':' || operation_code NOT IN (%s)" %
           kept)
objects = "SELECT auth_name || ':' || code FROM object_view UNION " + kept
for table, column in ("alias_name", ""), ("usage", "object_"):
    db.execute("DELETE FROM %s WHERE %sauth_name || ':' || %scode NOT IN (%s)" % (table, column, column, objects))
db.commit()
db.execute("VACUUM")
db.close()
