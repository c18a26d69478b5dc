namespace UnityEngine
{
    public struct Rect
    {
        public Rect(float x, float y, float width, float height)
        {
            this.x = x;
            this.y = y;
            this.width = width;
            this.height = height;
        }

        public float x { get; set; }

        public float y { get; set; }

        public float width { get; set; }

        public float height { get; set; }
    }

    public sealed class GUIContent
    {
        public GUIContent(string text)
        {
        }
    }

    public sealed class GUISkin
    {
        public GUIStyle label
        {
            get { return new GUIStyle(); }
        }
    }

    public sealed class GUIStyle
    {
        public GUIStyle()
        {
        }

        public GUIStyle(GUIStyle other)
        {
        }

        public int fontSize { get; set; }

        public bool wordWrap { get; set; }

        public float CalcHeight(GUIContent content, float width)
        {
            return 0f;
        }
    }

    public sealed class GUILayoutOption
    {
    }

    public static class GUI
    {
        public static Color backgroundColor { get; set; }

        public static bool enabled { get; set; }

        public static GUISkin skin
        {
            get { return new GUISkin(); }
        }

        /// <summary>The text that was written last. Not in Unity.</summary>
        public static string Said { get; private set; }

        public static void Label(Rect place, string text, GUIStyle style)
        {
            Said = text;
        }
    }

    public static class GUILayout
    {
        public static bool Button(string text, params GUILayoutOption[] options)
        {
            return false;
        }

        public static GUILayoutOption Height(float height)
        {
            return new GUILayoutOption();
        }

        public static GUILayoutOption Width(float width)
        {
            return new GUILayoutOption();
        }

        public static GUILayoutOption MinHeight(float height)
        {
            return new GUILayoutOption();
        }
    }
}
