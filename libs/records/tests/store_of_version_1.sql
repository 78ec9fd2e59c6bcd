-- A store as metier wrote it before it made rows of everything at once: three executions, of which the last
-- was under way when its server died, and a piece of the table `backlog` of that time.
BEGIN TRANSACTION;
CREATE TABLE backlog (life BIGINT NOT NULL, number BIGINT NOT NULL, server TEXT NOT NULL,
    under_way TEXT NOT NULL, content BLOB NOT NULL, PRIMARY KEY (life, number));
INSERT INTO backlog VALUES (7, 0, 'urn:test:ur5', '[]', X'0200424D');
CREATE TABLE executions (number INTEGER PRIMARY KEY AUTOINCREMENT,
    kind BIGINT NOT NULL, note BIGINT NOT NULL, started BIGINT NOT NULL, ended BIGINT NOT NULL,
    revision BIGINT NOT NULL, id TEXT NOT NULL, parent TEXT NOT NULL, parent_server TEXT NOT NULL,
    session TEXT NOT NULL, client_name TEXT NOT NULL, thumbprint TEXT NOT NULL,
    missed_cycles BIGINT NOT NULL, parameters TEXT NOT NULL, result TEXT NOT NULL,
    check_report TEXT NOT NULL);
INSERT INTO "executions" VALUES(1,1,0,1795501789221178,1795501789222178,1,'urn:test:ur5-1','','','s-7','metier command','ab12',2,'{"MaxVelocity":[1.0]}','{"Duration":1.0}','{"possible":true}');
INSERT INTO "executions" VALUES(2,1,0,1795501789223609,1795501789224609,2,'urn:test:ur5-2','','','s-7','metier command','ab12',2,'{"MaxVelocity":[1.0]}','{"Duration":1.0}','{"possible":true}');
INSERT INTO "executions" VALUES(3,2,0,1795501789223612,0,3,'urn:test:ur5-3','','','s-7','metier command','ab12',0,'{"MaxVelocity":[1.0]}','','{"possible":true}');
CREATE TABLE kinds (kind INTEGER PRIMARY KEY AUTOINCREMENT,
    server TEXT NOT NULL, server_name TEXT NOT NULL, controller TEXT NOT NULL, skill TEXT NOT NULL,
    device TEXT NOT NULL, user_name TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL,
    UNIQUE (server, server_name, controller, skill, device, user_name, state, reason));
INSERT INTO "kinds" VALUES(1,'urn:test:ur5','ur5','Controller','JointPtpMoveSkill','ur5','anna','Ready','Finished');
INSERT INTO "kinds" VALUES(2,'urn:test:ur5','ur5','Controller','JointPtpMoveSkill','ur5','anna','Running','');
CREATE TABLE metier_records (name TEXT PRIMARY KEY, value BIGINT NOT NULL);
INSERT INTO "metier_records" VALUES('schema_version',1);
INSERT INTO "metier_records" VALUES('revision',3);
CREATE TABLE notes (note INTEGER PRIMARY KEY AUTOINCREMENT, reason_text TEXT NOT NULL UNIQUE);
INSERT INTO "notes" VALUES(0,'');
CREATE TABLE parts (part BIGINT PRIMARY KEY, events TEXT NOT NULL, samples BLOB NOT NULL);
INSERT INTO "parts" VALUES(1048576,'[["t",1795501789221178,"Ready","Running","Executing","","",""],["t",1795501789222178,"Running","Ready","ReadyNotConfigured","","Finished",""],["i",1795501789221678,"0.5"]]',X'020000FCA9F1D24D62503F000000000000F03F000000000000F0BF');
INSERT INTO "parts" VALUES(2097152,'',X'020000FCA9F1D24D62503F000000000000004000000000000000C0');
INSERT INTO "parts" VALUES(3145728,'',X'020000FCA9F1D24D62503F000000000000084000000000000008C0');
CREATE INDEX executions_by_start ON executions (started, number);
CREATE INDEX executions_by_kind ON executions (kind, started, number);
CREATE INDEX executions_by_note ON executions (note, started, number) WHERE note <> 0;
CREATE INDEX executions_noted ON executions (started, number, note, kind) WHERE note <> 0;
CREATE INDEX executions_by_id ON executions (id);
CREATE INDEX executions_by_parent ON executions (parent) WHERE parent <> '';
CREATE INDEX executions_by_revision ON executions (revision);
CREATE INDEX executions_under_way ON executions (number) WHERE ended = 0;
CREATE VIEW history AS SELECT e.number, e.id, k.server, k.server_name, k.controller, k.skill,
    k.device, k.user_name, k.state, k.reason, n.reason_text, e.started, e.ended, e.parent,
    e.parent_server, e.session, e.client_name, e.thumbprint, e.missed_cycles, e.parameters,
    e.result, e.check_report, e.revision
    FROM executions e JOIN kinds k ON k.kind = e.kind JOIN notes n ON n.note = e.note;
COMMIT;
