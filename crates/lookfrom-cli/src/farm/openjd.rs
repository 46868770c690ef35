//! Open Job Description (2023-09, with the extension TASK_CHUNKING): a step for the parts, and one that merges them.

use serde_json::json;

use super::Job;
use crate::json::document;

/// The job template, and the files that a job bundle of Deadline Cloud uploads.
pub(super) fn files(job: &Job) -> Vec<(&'static str, String)> {
    let path = |name: &str, kind: &str, flow: &str, default: &str, about: &str| {
        json!({
            "name": name, "type": "PATH", "objectType": kind, "dataFlow": flow, "default": default, "description": about,
        })
    };
    let action = |arguments: [&str; 2]| {
        let [what, argument] = arguments;
        let mut all = vec!["{{Param.JobFolder}}/job.sh", what];
        all.extend((!argument.is_empty()).then_some(argument));
        // A part that is interrupted keeps what it has.
        json!({ "actions": { "onRun": {
            "command": "sh", "args": all,
            "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 60 },
        } } })
    };
    let environment = json!([{
        "name": "Lookfrom",
        "variables": {
            "LOOKFROM": "{{Param.Lookfrom}}", "SCENE": "{{Param.Scene}}", "FOLDER": "{{Param.Pictures}}",
        },
    }]);
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "extensions": ["TASK_CHUNKING"],
        "name": job.name,
        "parameterDefinitions": [
            path("Scene", "FILE", "IN", &job.scene.to_string_lossy(), "The scene"),
            path("JobFolder", "DIRECTORY", "IN", ".", "The folder of job.sh"),
            path("Pictures", "DIRECTORY", "INOUT", ".", "The folder of parts and pictures"),
            { "name": "Lookfrom", "type": "STRING", "default": "lookfrom", "description": "The program" },
            { "name": "TasksPerChunk", "type": "INT", "default": 1, "minValue": 1, "description": "Parts that one machine renders in a row" },
        ],
        "jobEnvironments": environment,
        "steps": [
            {
                "name": "Render",
                "parameterSpace": { "taskParameterDefinitions": [{
                    "name": "Task", "type": "CHUNK[INT]", "range": format!("1-{}", job.tasks()),
                    "chunks": { "defaultTaskCount": "{{Param.TasksPerChunk}}", "rangeConstraint": "CONTIGUOUS" },
                }] },
                "script": action(["part", "{{Task.Param.Task}}"]),
            },
            {
                "name": "Merge",
                "dependencies": [{ "dependsOn": "Render" }],
                "script": action(["merge", ""]),
            },
        ],
    });
    let inputs: Vec<String> = job.inputs.iter().map(|path| path.display().to_string()).collect();
    let references = json!({ "assetReferences": {
        "inputs": { "filenames": inputs, "directories": [] }, "outputs": { "directories": [] }, "referencedPaths": [],
    } });
    vec![("template.json", document(&template)), ("asset_references.json", document(&references))]
}
