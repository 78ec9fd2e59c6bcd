/* Entry points of the compiled NodeSets, for the one library that talks to open62541.
 *
 * Each adds the nodes of one namespace to a server and must be called after those that it requires,
 * from the thread that owns the server, before the server runs:
 *   di, ia, rob, device, robotics, metier, then iiwa, edo, universal_robots or wsg50.
 * A call needs all of its required namespaces and returns Good, or the first error; the server is
 * then not usable. All servers of one process must use the same order: the generated code keeps the
 * namespace indexes of its data types in static tables. */
#ifndef METIER_NODESETS_NODESETS_H
#define METIER_NODESETS_NODESETS_H

#include <open62541/server.h>

#ifdef __cplusplus
extern "C" {
#endif

/* OPC UA for Devices 1.04, IA 1.01.2 and Robotics (OPC 40010-1) 1.01.2. */
UA_StatusCode namespace_di_generated(UA_Server *server);
UA_StatusCode namespace_ia_generated(UA_Server *server);
UA_StatusCode namespace_rob_generated(UA_Server *server);

/* The skill model. */
UA_StatusCode namespace_device_generated(UA_Server *server);
UA_StatusCode namespace_robotics_generated(UA_Server *server);
UA_StatusCode namespace_metier_generated(UA_Server *server);

/* One robot each. */
UA_StatusCode namespace_iiwa_generated(UA_Server *server);
UA_StatusCode namespace_edo_generated(UA_Server *server);
UA_StatusCode namespace_universal_robots_generated(UA_Server *server);
UA_StatusCode namespace_wsg50_generated(UA_Server *server);

#ifdef __cplusplus
}
#endif

#endif
