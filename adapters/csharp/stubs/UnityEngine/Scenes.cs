using System.Collections.Generic;

namespace UnityEngine.SceneManagement
{
    public struct Scene
    {
        internal static readonly List<GameObject> All = new List<GameObject>();

        public GameObject[] GetRootGameObjects()
        {
            All.RemoveAll(made => made.Destroyed);
            return All.FindAll(made => made.transform.parent == null).ToArray();
        }
    }

    public static class SceneManager
    {
        public static Scene GetActiveScene()
        {
            return new Scene();
        }
    }
}
