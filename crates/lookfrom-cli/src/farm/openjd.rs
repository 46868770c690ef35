//! Open Job Description (2023-09, with the extension TASK_CHUNKING): a step for the parts, and one that merges them.

use super::Job;
use lookfrom_scene::json::{document, json};

/// The job template; the parameter that has no default, for `openjd run` and for a job bundle of Deadline Cloud; and the
/// files that the bundle uploads.
pub(super) fn files(job: &Job) -> Vec<(&'static str, String)> {
    // Defaults of paths are inside the job's folder; the scene is not, and is a parameter without one.
    let path = |name: &str, kind: &str, flow: &str, about: &str| json!({ "name": name, "type": "PATH", "objectType": kind, "dataFlow": flow, "description": about });
    let folder = |name: &str, flow: &str, about: &str| {
        let mut folder = path(name, "DIRECTORY", flow, about);
        folder["default"] = ".".into();
        folder
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
        "name": job_name(&job.name),
        "parameterDefinitions": [
            path("Scene", "FILE", "IN", "The scene"),
            folder("JobFolder", "IN", "The folder of job.sh"),
            folder("Pictures", "INOUT", "The folder of parts and pictures"),
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
    let scene = job.scene.to_string_lossy();
    let parameters = json!({ "Scene": scene });
    let of_bundle = json!({ "parameterValues": [{ "name": "Scene", "value": scene }] });
    vec![
        ("template.json", document(&template)),
        ("parameters.json", document(&parameters)),
        ("parameter_values.json", document(&of_bundle)),
        ("asset_references.json", document(&references)),
    ]
}

/// The name of the job: what the specification allows, and nothing that would be replaced as a reference to a parameter.
fn job_name(scene: &str) -> String {
    const LONGEST: usize = 128;
    let allowed = |c: char| match c {
        '{' => '(',
        '}' => ')',
        c if c.is_control() => ' ',
        c => c,
    };
    scene.chars().map(allowed).take(LONGEST).collect()
}
