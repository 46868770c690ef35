// What the browser remembers for this page: nothing, where a notebook shows it in a frame and the browser keeps other sites' memory shut.

/** @returns {Storage | null} */
export function memory() {
    try {
        return localStorage;
    } catch {
        return null;
    }
}
